!> Run-time of the stand-in for pFUnit: failures, the runner and the kernels of the assertions.
!>
!> The specific procedures of the assertions are generated (tools/funit_overloads.py) and call the
!> kernels below with rank-1 copies. Nothing here trips over NaN, Inf or floating-point traps.
module funit_lite
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use, intrinsic :: iso_fortran_env, only: int64, output_unit, real64
   implicit none (type, external)
   public

   private :: int64, output_unit, real64, ieee_is_finite, ieee_is_nan
   private :: where_is, conformable, report, real_text, integer_text, index_text, are_close, &
      abs_or_huge

   !> Where an assertion stands.
   type :: SourceLocation
      character(len=100) :: file_name = ''
      integer :: line = 0
   end type SourceLocation

   !> Runs tests, counts them and prints what failed.
   type :: pf_runner_t
      private
      integer :: passed = 0, failed = 0
      logical :: is_verbose = .false.
      character(len=200) :: filter = '', current = ''
      character(:), allocatable :: failures
   contains
      procedure :: begin => runner_begin
      procedure :: starts => runner_starts
      procedure :: ends => runner_ends
      procedure :: finish => runner_finish
   end type pf_runner_t

   !> Failures of the test that is running.
   character(:), allocatable, private :: failure_text

   !> True for a scalar or rank-1 condition.
   interface assertTrue
      module procedure :: assert_true_scalar
      module procedure :: assert_all
   end interface assertTrue
   private :: assert_true_scalar, assert_all

   !> False for a scalar or rank-1 condition.
   interface assertFalse
      module procedure :: assert_false_scalar
      module procedure :: assert_none
   end interface assertFalse
   private :: assert_false_scalar, assert_none

   private :: runner_begin, runner_starts, runner_ends, runner_finish

contains

   !> True while the running test has a failure.
   function anyExceptions() result(is_failing)
      logical :: is_failing

      is_failing = allocated(failure_text)
   end function anyExceptions

   !> Notes a failure of the running test.
   subroutine report(text, message, location)
      character(*), intent(in) :: text
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      character(:), allocatable :: whole

      whole = '  ' // where_is(location) // new_line('a')
      if (present(message)) whole = whole // '  ' // message // new_line('a')
      whole = whole // '  ' // text // new_line('a')
      if (allocated(failure_text)) whole = failure_text // whole
      call move_alloc(whole, failure_text)
   end subroutine report

   function where_is(location) result(string)
      type(SourceLocation), intent(in), optional :: location
      character(:), allocatable :: string

      string = '[unknown place]'
      if (present(location)) string = '[' // trim(location%file_name) // ':' &
         // integer_text(int(location%line, int64)) // ']'
   end function where_is

   function real_text(value) result(string)
      real(real64), intent(in) :: value
      character(:), allocatable :: string
      character(len=32) :: buffer

      write (buffer, '(es24.16e3)') value
      string = trim(adjustl(buffer))
   end function real_text

   function integer_text(value) result(string)
      integer(int64), intent(in) :: value
      character(:), allocatable :: string
      character(len=24) :: buffer

      write (buffer, '(i0)') value
      string = trim(buffer)
   end function integer_text

   !> Index of the element `position` of an array of shape `extents`, as text: ` at (2,3)`; empty
   !> for a scalar.
   function index_text(position, extents) result(string)
      integer, intent(in) :: position
      integer, intent(in) :: extents(:)
      character(:), allocatable :: string
      integer :: rest, i

      string = ''
      rest = position - 1
      do i = 1, size(extents)
         if (i > 1) string = string // ','
         string = string // integer_text(int(mod(rest, extents(i)) + 1, int64))
         rest = rest/extents(i)
      end do
      if (size(extents) > 0) string = ' at (' // string // ')'
   end function index_text

   !> True if the left side is a scalar or has the shape of the right side; reports it otherwise.
   function conformable(left, right, message, location) result(is_good)
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      logical :: is_good

      is_good = size(left) == 0
      if (.not. is_good) is_good = size(left) == size(right)
      if (is_good .and. size(left) > 0) is_good = all(left == right)
      if (.not. is_good) call report('Arrays not conformable.', message, location)
   end function conformable

   !> |actual - expected| <= tolerance in every element; NaN never equals anything, equal infinities
   !> do.
   subroutine check_real_equal(expected, left, actual, right, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:), tolerance
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i
      real(real64) :: wanted
      character(:), allocatable :: text

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(actual)
         wanted = expected(min(i, size(expected)))
         if (are_close(wanted, actual(i), tolerance)) cycle
         text = 'expected ' // real_text(wanted) // ', found ' // real_text(actual(i)) &
            // index_text(i, right)
         if (max(abs_or_huge(wanted), abs_or_huge(actual(i))) < 0.5_real64*huge(wanted)) text = &
            text // ', difference ' &
            // real_text(actual(i) - wanted) // ', tolerance ' // real_text(tolerance)
         call report(text, message, location)
         return
      end do
   end subroutine check_real_equal

   !> |value|, or the largest number for NaN and Inf: what can be subtracted without a trap.
   function abs_or_huge(value) result(size_of_it)
      real(real64), intent(in) :: value
      real(real64) :: size_of_it

      size_of_it = huge(value)
      if (ieee_is_finite(value)) size_of_it = abs(value)
   end function abs_or_huge

   !> |a - b| <= tolerance, without overflow; false with NaN.
   function are_close(a, b, tolerance) result(are_near)
      real(real64), intent(in) :: a, b, tolerance
      logical :: are_near

      are_near = .false.
      if (ieee_is_nan(a) .or. ieee_is_nan(b)) return
      are_near = .not. (a < b .or. a > b)
      if (are_near .or. .not. (ieee_is_finite(a) .and. ieee_is_finite(b))) return
      are_near = abs(0.5_real64*a - 0.5_real64*b) <= 0.5_real64*tolerance
   end function are_close

   !> |actual - expected| <= tolerance*|expected|; an expected zero always fails.
   subroutine check_real_relative(expected, left, actual, right, tolerance, message, location)
      real(real64), intent(in) :: expected(:), actual(:), tolerance
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i
      real(real64) :: wanted
      logical :: is_good

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(actual)
         wanted = expected(min(i, size(expected)))
         is_good = ieee_is_finite(wanted) .and. abs(wanted) > 0.0_real64
         if (is_good) is_good = are_close(wanted, actual(i), tolerance*abs(wanted))
         if (is_good) cycle
         call report('expected ' // real_text(wanted) // ', found ' // real_text(actual(i)) &
            // index_text(i, right) &
                     // ', relative tolerance ' // real_text(tolerance), message, location)
         return
      end do
   end subroutine check_real_relative

   !> lhs < rhs + tolerance (or <=, >, >=) in every element; false with NaN.
   subroutine check_real_order(operator, lhs, left, rhs, right, tolerance, message, location)
      character(*), intent(in) :: operator
      real(real64), intent(in) :: lhs(:), rhs(:), tolerance
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i
      real(real64) :: value
      logical :: is_good

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(rhs)
         value = lhs(min(i, size(lhs)))
         is_good = .not. (ieee_is_nan(value) .or. ieee_is_nan(rhs(i)))
         if (is_good) then
            select case (operator)
            case ('<')
               is_good = value < rhs(i) + tolerance
            case ('<=')
               is_good = value <= rhs(i) + tolerance
            case ('>')
               is_good = value > rhs(i) - tolerance
            case default
               is_good = value >= rhs(i) - tolerance
            end select
         end if
         if (is_good) cycle
         call report('not true: ' // real_text(value) // ' ' // operator // ' ' &
            // real_text(rhs(i)) &
                     // index_text(i, right), message, location)
         return
      end do
   end subroutine check_real_order

   !> Equal integers in every element.
   subroutine check_integer_equal(expected, left, actual, right, message, location)
      integer(int64), intent(in) :: expected(:), actual(:)
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i
      integer(int64) :: wanted

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(actual)
         wanted = expected(min(i, size(expected)))
         if (wanted == actual(i)) cycle
         call report('expected ' // integer_text(wanted) // ', found ' // integer_text(actual(i)) &
                     // index_text(i, right), message, location)
         return
      end do
   end subroutine check_integer_equal

   !> lhs < rhs (or <=, >, >=) in every element.
   subroutine check_integer_order(operator, lhs, left, rhs, right, message, location)
      character(*), intent(in) :: operator
      integer(int64), intent(in) :: lhs(:), rhs(:)
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i
      integer(int64) :: value
      logical :: is_good

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(rhs)
         value = lhs(min(i, size(lhs)))
         select case (operator)
         case ('<')
            is_good = value < rhs(i)
         case ('<=')
            is_good = value <= rhs(i)
         case ('>')
            is_good = value > rhs(i)
         case default
            is_good = value >= rhs(i)
         end select
         if (is_good) cycle
         call report('not true: ' // integer_text(value) // ' ' // operator // ' ' &
            // integer_text(rhs(i)) &
                     // index_text(i, right), message, location)
         return
      end do
   end subroutine check_integer_order

   !> Equal logicals in every element.
   subroutine check_logical_equal(expected, left, actual, right, message, location)
      logical, intent(in) :: expected(:), actual(:)
      integer, intent(in) :: left(:), right(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location
      integer :: i

      if (.not. conformable(left, right, message, location)) return
      do i = 1, size(actual)
         if (expected(min(i, size(expected))) .eqv. actual(i)) cycle
         call report('expected ' // merge('true ', 'false', &
            expected(min(i, size(expected)))) // index_text(i, right), &
                     message, location)
         return
      end do
   end subroutine check_logical_equal

   !> Equal strings; leading and trailing blanks do not count.
   subroutine check_string_equal(expected, found, message, location)
      character(*), intent(in) :: expected, found
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (trim(adjustl(expected)) == trim(adjustl(found))) return
      call report('expected "' // expected // '"' // new_line('a') // '  found    "' // found &
         // '"', message, location)
   end subroutine check_string_equal

   subroutine assert_true_scalar(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (.not. condition) call report('is false, should be true', message, location)
   end subroutine assert_true_scalar

   subroutine assert_false_scalar(condition, message, location)
      logical, intent(in) :: condition
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (condition) call report('is true, should be false', message, location)
   end subroutine assert_false_scalar

   !> Every condition is true.
   subroutine assert_all(conditions, message, location)
      logical, intent(in) :: conditions(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (.not. all(conditions)) call report('not all are true' // index_text(findloc(conditions, &
         .false., 1), &
                                             shape(conditions)), message, location)
   end subroutine assert_all

   !> No condition is true.
   subroutine assert_none(conditions, message, location)
      logical, intent(in) :: conditions(:)
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (any(conditions)) call report('one is true' // index_text(findloc(conditions, .true., &
         1), shape(conditions)), &
                                       message, location)
   end subroutine assert_none

   !> The number is NaN.
   subroutine assertIsNaN(x, message, location)
      real(real64), intent(in) :: x
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (.not. ieee_is_nan(x)) call report('not a NaN: ' // real_text(x), message, location)
   end subroutine assertIsNaN

   !> The number is neither NaN nor infinite.
   subroutine assertIsFinite(x, message, location)
      real(real64), intent(in) :: x
      character(*), intent(in), optional :: message
      type(SourceLocation), intent(in), optional :: location

      if (.not. ieee_is_finite(x)) call report('not finite: ' // real_text(x), message, location)
   end subroutine assertIsFinite

   !> Fails.
   subroutine assertFail(message, location)
      character(*), intent(in) :: message
      type(SourceLocation), intent(in), optional :: location

      call report('intentional failure', message, location)
   end subroutine assertFail

   !> Reads the command line: -v lists every test, -f TEXT runs only tests whose name contains TEXT.
   subroutine runner_begin(self)
      class(pf_runner_t), intent(inout) :: self
      integer :: i
      character(len=200) :: argument

      self%failures = ''
      i = 1
      do while (i <= command_argument_count())
         call get_command_argument(i, argument)
         select case (argument)
         case ('-v')
            self%is_verbose = .true.
         case ('-f')
            i = i + 1
            call get_command_argument(i, self%filter)
         case default
            write (output_unit, '(a)') 'unknown option ' // trim(argument) // '; known: -v, -f TEXT'
            stop 3
         end select
         i = i + 1
      end do
   end subroutine runner_begin

   !> True if the test is to run.
   logical function runner_starts(self, name) result(starts)
      class(pf_runner_t), intent(inout) :: self
      character(*), intent(in) :: name

      starts = index(name, trim(self%filter)) > 0
      if (.not. starts) return
      self%current = name
      if (self%is_verbose) write (output_unit, '(a)') name
      flush (output_unit)
      if (allocated(failure_text)) deallocate (failure_text)
   end function runner_starts

   !> Counts the test that has just run.
   subroutine runner_ends(self)
      class(pf_runner_t), intent(inout) :: self
      character :: mark

      mark = merge('F', '.', allocated(failure_text))
      if (allocated(failure_text)) then
         self%failed = self%failed + 1
         self%failures = self%failures // 'Failure in ' // trim(self%current) // new_line('a') &
            // failure_text // new_line('a')
         deallocate (failure_text)
      else
         self%passed = self%passed + 1
      end if
      if (.not. self%is_verbose) write (output_unit, '(a)', advance='no') mark
      if (self%is_verbose .and. mark == 'F') write (output_unit, '(a)') '   FAILED'
   end subroutine runner_ends

   !> Prints the failures and the count; exit status 0 all passed, 1 some failed, 2 nothing ran.
   subroutine runner_finish(self)
      class(pf_runner_t), intent(inout) :: self

      if (.not. self%is_verbose) write (output_unit, '(a)') ''
      write (output_unit, '(a)', advance='no') self%failures
      write (output_unit, '(i0,a,i0,a)') self%passed, ' passed, ', self%failed, ' failed'
      flush (output_unit)
      if (self%passed + self%failed == 0) stop 2, quiet=.true.
      if (self%failed > 0) stop 1, quiet=.true.
   end subroutine runner_finish

end module funit_lite
