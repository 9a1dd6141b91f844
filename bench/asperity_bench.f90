!> Solves many contacts in one process and prints a line of comma-separated values for each: for
!> bench, chart and maps.
!>
!>     asperity-bench JOBS      a file of namelists, each below a line
!>                              `#job runs seconds limit reference compare bars name`
!>
!> After the head come, for each job, lines `times,name,setup,steady,transient,all` of its runs and
!> a line of values, or `refused,name,"message"` for a namelist with findings.
program asperity_bench
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use bench_measure, only: job_t, measure, measurement_t
   use errors, only: error_t
   use kinds, only: wp
   use quantities, only: friction_coefficient, h_central, h_min, p_max
   use text_file, only: read_text_file
   implicit none (type, external)

   character(len=*), parameter :: marker = '#job '
   type(error_t), allocatable :: error
   real(wp), allocatable :: reference(:, :)
   type(measurement_t) :: outcome
   type(job_t) :: job
   character(:), allocatable :: content
   character(len=4096) :: file
   integer :: next

   call get_command_argument(1, file)
   call read_text_file(trim(file), content, error)
   if (allocated(error)) call stop_with(error%message)
   write (output_unit, '(a)') 'name,method,grid,converged,intervals,x_inlet,x_outlet,levels,'// &
      'cycles,steps,residual,load_error,tolerance,step_residual,fft_pairs,work_units,'// &
      'processor,h_min,h_central,p_max,friction_coefficient,difference,reason'
   do while (index(content, marker) == 1)
      next = index(content(2:), marker)
      if (next == 0) next = len(content)
      call read_job(content(:next), job)
      call measure(job, reference, outcome, error)
      if (allocated(error)) then
         write (output_unit, '(5a)') 'refused,"', job%name, '","', flat(error%message), '"'
      else
         call print_outcome(job, outcome)
      end if
      flush (output_unit)
      content = content(next + 1:)
   end do

contains

   !> One job from its lines.
   subroutine read_job(text, job)
      character(*), intent(in) :: text
      type(job_t), intent(out) :: job
      integer :: flags(3)
      integer :: line_end, status

      line_end = index(text, new_line('a'))
      associate (head => text(len(marker):line_end - 1))
         read (head, *, iostat=status) job%runs, job%seconds, job%limit, flags
         if (status /= 0) call stop_with('found '//head//', expected six numbers and a name')
         job%name = head(index(head, ' ', back=.true.) + 1:)
      end associate
      job%is_reference = flags(1) /= 0
      job%is_compared = flags(2) /= 0
      job%has_bars = flags(3) /= 0
      job%text = text(line_end + 1:)
   end subroutine read_job

   !> The times of each run, and a line of values, the last one text in quotes.
   subroutine print_outcome(job, outcome)
      type(job_t), intent(in) :: job
      type(measurement_t), intent(in) :: outcome
      integer :: run

      do run = 1, size(outcome%times, 2)
         write (output_unit, '(3a,4(",",es11.4))') 'times,"', job%name, '"', outcome%times(:, run)
      end do
      associate (report => outcome%report, first => outcome%first, domain => outcome%contact%domain)
         write (output_unit, '(7a,2(",",i0),2(",",g0),3(",",i0),4(",",es10.3e3),",",i0,",",'// &
            'es12.5,6(",",es24.16e3),3a)') '"', job%name, '","', report%method, '","', &
            trim(domain%grid), '"', merge(1, 0, report%converged), domain%intervals, &
            domain%x_inlet, domain%x_outlet, report%numbers%levels, report%cycles, report%steps, &
            report%residual, report%load_error, report%tolerance_effective, first%residual, &
            report%cost%fft_pairs, report%cost%work_units, outcome%processor, &
            first%summary%of([h_min, h_central, p_max, friction_coefficient])%value, &
            outcome%difference, ',"', flat(report%reason), '"'
      end associate
   end subroutine print_outcome

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

   !> Ends with status 1.
   subroutine stop_with(message)
      character(*), intent(in) :: message

      write (error_unit, '(a)') message
      stop 1, quiet=.true.
   end subroutine stop_with

end program asperity_bench
