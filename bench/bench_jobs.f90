!> The list of jobs of the bench program: namelists, each below a line `#job key=value ...`.
module bench_jobs
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: job_t, split_jobs

   !> A namelist and what is done with it.
   type :: job_t
      !> Name of its line in the output.
      character(:), allocatable :: name
      !> The namelist.
      character(:), allocatable :: text
      !> Runs at most.
      integer :: runs = 1
      !> No further run after this many seconds of runs [s].
      real(wp) :: seconds = 1.0e9_wp
      !> A run is stopped after this time, between cycles [s].
      real(wp) :: limit = 1.0e9_wp
      !> Its fields become the reference of later jobs.
      logical :: is_reference = .false.
      !> Its fields are compared with the last reference.
      logical :: is_compared = .false.
      !> Its errors are estimated.
      logical :: has_bars = .false.
      !> The residual of each cycle is printed.
      logical :: shows_history = .false.
      !> The share of the kernel products in the steady solution is measured.
      logical :: shows_products = .false.
   end type job_t

   character(len=*), parameter :: marker = '#job'
   character(len=1), parameter :: line_feed = achar(10)

contains

   !> Cuts `content` into jobs. Error (input_error): a word of a `#job` line that is not understood.
   pure subroutine split_jobs(content, jobs, error)
      character(*), intent(in) :: content
      type(job_t), allocatable, intent(out) :: jobs(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: first, last, head_end, i, count

      count = 0
      first = 1
      do
         i = index(content(first:), marker)
         if (i == 0) exit
         count = count + 1
         first = first + i
      end do
      allocate (jobs(count))
      first = index(content, marker)
      do i = 1, count
         last = index(content(first + 1:), marker)
         last = merge(first + last - 1, len(content), last > 0)
         head_end = first + index(content(first:last), line_feed) - 1
         call read_head(content(first + len(marker):head_end - 1), jobs(i), error)
         if (allocated(error)) return
         jobs(i)%text = content(head_end + 1:last)
         first = last + 1
      end do
   end subroutine split_jobs

   !> The words `key=value` behind `#job`.
   pure subroutine read_head(line, job, error)
      character(*), intent(in) :: line
      type(job_t), intent(inout) :: job
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: rest, word
      integer :: blank, equals, status

      rest = trim(adjustl(line))
      job%name = '-'
      do while (len(rest) > 0)
         blank = index(rest//' ', ' ')
         word = rest(:blank - 1)
         rest = trim(adjustl(rest(blank:)))
         equals = index(word, '=')
         status = 1
         if (equals > 1) call take(word(:equals - 1), word(equals + 1:), job, status)
         if (status /= 0) then
            call fail(error, input_error, 'found '//word//' in a line '//marker &
               //', expected name, runs, seconds, limit, '// &
               'reference, compare, bars, history or products = value')
            return
         end if
      end do
   end subroutine read_head

   !> One pair; `status` is not zero if it is not understood.
   pure subroutine take(key, value, job, status)
      character(*), intent(in) :: key, value
      type(job_t), intent(inout) :: job
      integer, intent(out) :: status
      integer :: flag

      status = 0
      flag = 0
      select case (key)
      case ('name')
         job%name = value
      case ('runs')
         read (value, *, iostat=status) job%runs
      case ('seconds')
         read (value, *, iostat=status) job%seconds
      case ('limit')
         read (value, *, iostat=status) job%limit
      case ('reference', 'compare', 'bars', 'history', 'products')
         read (value, *, iostat=status) flag
      case default
         status = 1
      end select
      if (status /= 0) return
      if (key == 'reference') job%is_reference = flag /= 0
      if (key == 'compare') job%is_compared = flag /= 0
      if (key == 'bars') job%has_bars = flag /= 0
      if (key == 'history') job%shows_history = flag /= 0
      if (key == 'products') job%shows_products = flag /= 0
   end subroutine take

end module bench_jobs
