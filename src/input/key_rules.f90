!> The rules of the key table (see module key_condition) over the values of a case, and the values
!> that are possible but that no usual contact has: most often numbers in another unit.
module key_rules
   use input_keys, only: find_group, find_key, group_rows, key_rows
   use input_values, only: input_values_t, value_t
   use key_condition, only: condition_t, conditions_of, name_of, shown
   use key_row, only: has_word, is_required, is_typical, key_row_t, unit_question
   use kinds, only: wp
   use number_text, only: read_real
   use quantity_text, only: number_text
   implicit none (type, external)
   private

   public :: check_rules, find_unusual, is_used, unusual_t

   !> Whether a condition holds; unknown: a value cannot be read, or only some of several hold.
   integer, parameter :: no = -1, unknown = 0, yes = 1

   !> What is unusual in a key, or was assumed for it.
   type :: unusual_t
      !> Line of the key in the file.
      integer :: line
      !> "&bodies radius_1: 12.0 m is unusual, typical is 1e-4 to 5 m"
      character(:), allocatable :: words
      !> What the log adds.
      character(:), allocatable :: question
   end type unusual_t

contains

   !> Finds keys that are given and not used, and keys that are needed and not given.
   subroutine check_rules(values)
      type(input_values_t), intent(inout) :: values
      integer :: i

      do i = 1, size(key_rows)
         associate (row => key_rows(i))
            if (.not. has_word(row%problems, trim(values%problem))) cycle
            if (values%slots(i)%is_given) then
               call check_use(values, row)
            else if (values%has_group(row%group)) then
               call check_need(values, row)
            end if
         end associate
      end do
   end subroutine check_rules

   !> Finding, for each condition that does not hold: a key that is given and not used.
   subroutine check_use(values, row)
      type(input_values_t), intent(inout) :: values
      type(key_row_t), intent(in) :: row
      type(condition_t), allocatable :: conditions(:)
      character(:), allocatable :: reason
      integer :: i

      conditions = conditions_of(row%used, row%group)
      do i = 1, size(conditions)
         if (truth(values, conditions(i)) /= no) cycle
         reason = opposite(values, conditions(i))
         if (conditions(i)%reason /= '') reason = reason//', '//trim(conditions(i)%reason)
         call values%refuse_unused(trim(row%group), trim(row%key), reason)
      end do
   end subroutine check_use

   !> Whether a case has any use for a key.
   logical function is_used(values, row)
      type(input_values_t), intent(in) :: values
      type(key_row_t), intent(in) :: row
      type(condition_t), allocatable :: conditions(:)
      integer :: i

      conditions = conditions_of(row%used, row%group)
      is_used = all([(truth(values, conditions(i)) /= no, i=1, size(conditions))])
   end function is_used

   !> Finding: a key that is not given and must be.
   subroutine check_need(values, row)
      type(input_values_t), intent(inout) :: values
      type(key_row_t), intent(in) :: row
      type(condition_t), allocatable :: conditions(:)
      character(:), allocatable :: reason
      integer :: i

      if (row%default /= is_required .and. row%needed == '') return
      conditions = conditions_of(row%needed, row%group)
      reason = ''
      do i = 1, size(conditions)
         if (truth(values, conditions(i)) /= yes) return
         reason = trim(conditions(i)%reason)
      end do
      call values%refuse_missing(trim(row%group), trim(row%key), reason)
   end subroutine check_need

   !> Whether a condition holds, on either surface if it is about one.
   integer function truth(values, condition)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition

      if (condition%group == 'surface') then
         truth = max(truth_in(values, condition, 'surface_1'), &
            truth_in(values, condition, 'surface_2'))
      else
         truth = truth_in(values, condition, trim(condition%group))
      end if
   end function truth

   !> Whether a condition holds in `group`.
   integer function truth_in(values, condition, group) result(truth)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition
      character(*), intent(in) :: group
      logical :: holds
      integer :: row

      if (condition%key == '') then
         holds = values%has_group(group)
         if (holds) holds = has_word(group_rows(find_group(group))%problems, trim(values%problem))
         if (condition%relation == 'without') holds = .not. holds
         truth = merge(yes, no, holds)
      else
         truth = unknown
         row = find_key(group, trim(condition%key), values%problem)
         if (row > 0) truth = truth_of(values%slots(row), condition)
      end if
   end function truth_in

   !> Whether a condition holds for the key of a `slot`.
   integer function truth_of(slot, condition) result(truth)
      type(value_t), intent(in) :: slot
      type(condition_t), intent(in) :: condition
      real(wp) :: number
      logical, allocatable :: among(:)
      logical :: holds
      integer :: i

      truth = unknown
      select case (condition%relation)
      case ('with')
         holds = slot%is_given
      case ('without')
         holds = .not. slot%is_given
      case ('/=')
         if (.not. slot%has_value) return
         call read_real(trim(condition%values), number, holds)
         holds = abs(slot%reals(1) - number) > 0.0_wp
      case default
         if (.not. slot%has_value .or. any(slot%words == '?')) return
         among = [(has_word(trim(condition%values), trim(slot%words(i))), i=1, size(slot%words))]
         if (any(among) .neqv. all(among)) return
         holds = all(among)
      end select
      truth = merge(yes, no, holds)
   end function truth_of

   !> What is the case where a condition does not hold: "with shape = 'smooth'".
   function opposite(values, condition) result(text)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition
      character(:), allocatable :: text
      type(value_t) :: slot

      select case (condition%relation)
      case ('with')
         text = 'without '//name_of(condition)
      case ('without')
         text = 'with '//name_of(condition)
      case ('/=')
         text = 'with '//trim(condition%key)//' = '//trim(condition%values)
      case default
         if (condition%group == 'surface') then
            text = 'without '//trim(condition%key)//' = '//shown(condition%values)
         else
            slot = values%slot(trim(condition%group), trim(condition%key))
            text = 'with '//trim(condition%key)//' = '//shown(slot%words(1))
         end if
      end select
   end function opposite

   !> Given keys outside the typical range of their row, each with the first value that is.
   pure function find_unusual(values) result(unusual)
      type(input_values_t), intent(in) :: values
      type(unusual_t), allocatable :: unusual(:)
      character(:), allocatable :: question
      integer :: i, place

      allocate (unusual(0))
      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => values%slots(i))
            if (row%typical == '' .or. .not. (any(slot%is_set) .and. slot%has_value)) cycle
            if (.not. has_word(row%problems, trim(values%problem))) cycle
            place = findloc(is_typical(slot%reals, row%typical), .false., dim=1)
            if (place == 0) cycle
            question = slot%hint
            if (question == '') question = unit_question(row, slot%reals(place))
            if (question == '') question = '; is the unit right?'
            unusual = [unusual, unusual_t(slot%line, '&'//trim(row%group)//' '//trim(row%key) &
               //': '//number_text(slot%reals(place), 3)//' '//trim(row%unit) &
               //' is unusual, typical is '//trim(row%typical)//' '//trim(row%unit), question)]
         end associate
      end do
   end function find_unusual

end module key_rules
