!> Solves many contacts in one process and prints a line of comma-separated values for each: for
!> bench, chart and maps.
!>
!>     asperity-bench JOBS      a file of namelists, each below a line `#job key=value ...`
!>                              (module bench_jobs)
!>
!> After the head come lines of values, `history,name,cycle,residual,load_error` where asked for,
!> and `refused,name,"message"` for a namelist with findings.
program asperity_bench
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use bench_jobs, only: job_t, split_jobs
   use bench_measure, only: measure, measurement_t
   use errors, only: error_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use quantities, only: h_central, h_min, h_min_node, p_max, x_cavitation
   use text_file, only: read_text_file
   implicit none (type, external)

   type(job_t), allocatable :: jobs(:)
   type(error_t), allocatable :: error
   real(wp), allocatable :: reference(:, :)
   type(measurement_t) :: outcome
   character(:), allocatable :: content
   character(len=4096) :: file
   integer :: i

   call get_command_argument(1, file)
   call read_text_file(trim(file), content, error)
   if (.not. allocated(error)) call split_jobs(content, jobs, error)
   call stop_on(error)
   write (output_unit, '(a)') &
      'name,method,inlet,converged,intervals,x_inlet,x_outlet,levels,cycles,steps,'// &
      'residual,load_error,tolerance,step_residual,fft_pairs,work_units,runs,'// &
      'setup_least,steady_least,transient_least,all_least,setup_median,steady_median,'// &
      'transient_median,all_median,setup_high,steady_high,transient_high,all_high,'// &
      'processor,h_min,h_central,p_max,x_cavitation,'// &
      'difference,product_seconds,h_min_node,h_min_error,h_min_node_error,'// &
      'h_central_error,p_max_error,x_cavitation_error,h_min_error_grid,'// &
      'h_min_node_error_grid,h_central_error_grid,p_max_error_grid,'// &
      'x_cavitation_error_grid,reason'
   do i = 1, size(jobs)
      call measure(jobs(i), reference, outcome, error)
      if (allocated(error)) then
         write (output_unit, '(5a)') 'refused,"', jobs(i)%name, '","', flat(error%message), '"'
      else
         call print_outcome(jobs(i), outcome)
         if (jobs(i)%shows_history) call print_history(jobs(i), outcome)
      end if
      flush (output_unit)
   end do

contains

   !> One line; its last value is text in quotes.
   subroutine print_outcome(job, outcome)
      type(job_t), intent(in) :: job
      type(measurement_t), intent(in) :: outcome
      integer :: converged

      associate (report => outcome%report, first => outcome%first, domain => outcome%contact%domain)
         converged = merge(1, 0, report%converged)
         write (output_unit, '(7a)', advance='no') '"', job%name, '","', report%method, '","', &
            trim(domain%inlet), '"'
         write (output_unit, &
            '(2(",",i0),2(",",g0),3(",",i0),4(",",es10.3e3),",",i0,",",es12.5,",",i0)', &
            advance='no') converged, &
            domain%intervals, domain%x_inlet, domain%x_outlet, report%levels, report%cycles, &
               report%steps, report%residual, &
            report%load_error, report%tolerance_effective, first%residual, report%fft_pairs, &
               report%work_units, outcome%runs
         write (output_unit, '(13(",",es11.4),4(",",es24.16e3),2(",",es12.4e3))', advance='no') &
            outcome%least, outcome%median, outcome%high, outcome%processor, &
            first%summary%of([h_min, h_central, p_max, x_cavitation])%value, outcome%difference, &
            outcome%product_seconds
         call print_errors(first%summary)
         write (output_unit, '(3a)') ',"', flat(report%reason), '"'
      end associate
   end subroutine print_outcome

   !> Smallest nodal film, and the estimated errors, whole and of the grid; NaN: not estimated.
   subroutine print_errors(summary)
      type(line_summary_t), intent(in) :: summary

      associate (found => summary%of([h_min, h_min_node, h_central, p_max, x_cavitation]))
         write (output_unit, '(11(",",es24.16e3))', advance='no') summary%of(h_min_node)%value, &
            found%error_estimate, found%error_grid
      end associate
   end subroutine print_errors

   !> A line `history,name,cycle,residual,load_error` for each cycle.
   subroutine print_history(job, outcome)
      type(job_t), intent(in) :: job
      type(measurement_t), intent(in) :: outcome
      real(wp), allocatable :: residuals(:), load_errors(:)
      integer :: cycle

      allocate (residuals, source=outcome%report%residual_history())
      allocate (load_errors, source=outcome%report%load_error_history())
      do cycle = 1, size(residuals)
         write (output_unit, '(3a,i0,2(",",es10.3))') 'history,"', job%name, '",', cycle, &
            residuals(cycle), load_errors(cycle)
      end do
   end subroutine print_history

   !> A message in one line without double quotes.
   pure function flat(message) result(line)
      character(*), intent(in) :: message
      character(len=len(message)) :: line
      integer :: i

      line = message
      do i = 1, len(line)
         if (line(i:i) == '"') line(i:i) = achar(39)
         if (iachar(line(i:i)) < 32) line(i:i) = ' '
      end do
   end function flat

   !> Ends with status 1 on an error.
   subroutine stop_on(error)
      type(error_t), allocatable, intent(in) :: error

      if (.not. allocated(error)) return
      write (error_unit, '(a)') error%message
      stop 1, quiet=.true.
   end subroutine stop_on

end program asperity_bench
