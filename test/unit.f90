!> Runs the unit tests: `make unit` translates test/unit/<layer>/test_*.pf into test/generated/
!> first.
program unit
   use pf_suites, only: run_suites
   implicit none (type, external)

   call run_suites()
end program unit
