!> The rules of the key table, with what a key is used and with what it must be given, as text and
!> over the values of a case; and the values that are possible but that no usual contact has: most
!> often numbers in another unit.
!>
!> A rule is a list of conditions, separated by commas, which must all hold:
!>
!>     shape = feature sinusoid   the key has one of these values
!>     moes_l /= 0                the key does not have this value
!>     film_floor                 the key is given
!>     no film_floor              the key is not given
!>
!> A key of another group is written group%key, that of either surface surface%key, a whole group
!> &group. Words after a colon go into the message of the last condition.
module key_rules
   use input_keys, only: find_group, find_key, group_rows, key_rows
   use input_values, only: input_values_t
   use key_row, only: has_word, is_in_range, key_t, split_words, unit_question, word_list
   use kinds, only: wp
   use number_text, only: read_real
   use text, only: number_text
   implicit none (type, external)
   private

   public :: check_rules, condition_t, conditions_of, find_unusual, is_used, rules_text, &
      unusual_t

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

   !> One condition.
   type :: condition_t
      !> 'with' or 'without' a key or group, or '=' or '/='.
      character(len=8) :: relation = 'with'
      !> The group, 'surface' for either surface; the key, empty for the group as a whole.
      character(len=24) :: group, key
      !> What follows '=' or '/='.
      character(len=80) :: values = ''
      !> What follows the colon.
      character(len=80) :: reason = ''
      !> What the condition is about: "film_floor", "&accuracy target" or "&moes".
      character(len=80) :: name
   end type condition_t

contains

   !> Finds keys that are given and not used, for each condition that does not hold, and keys that
   !> are needed and not given.
   subroutine check_rules(values)
      type(input_values_t), intent(inout) :: values
      type(condition_t), allocatable :: conditions(:)
      character(:), allocatable :: reason
      integer :: i, k

      do i = 1, size(key_rows)
         associate (row => key_rows(i))
            if (.not. has_word(row%problems, values%problem)) cycle
            if (values%slots(i)%is_given) then
               conditions = conditions_of(row%used, row%group)
               do k = 1, size(conditions)
                  if (truth(values, conditions(k)) == no) call values%refuse_unused(row%group, &
                     row%key, opposite(values, conditions(k)))
               end do
            else if (values%has_group(row%group) .and. (row%default == 'required' &
               .or. row%needed /= '')) then
               conditions = conditions_of(row%needed, row%group)
               if (.not. all(truth(values, conditions) == yes)) cycle
               reason = ''
               if (size(conditions) > 0) reason = trim(conditions(size(conditions))%reason)
               call values%refuse_missing(row%group, row%key, reason)
            end if
         end associate
      end do
   end subroutine check_rules

   !> Whether a case has any use for a key.
   pure logical function is_used(values, row)
      type(input_values_t), intent(in) :: values
      type(key_t), intent(in) :: row

      is_used = row%used == ''
      if (.not. is_used) is_used = all(truth(values, conditions_of(row%used, row%group)) /= no)
   end function is_used

   !> Whether a condition holds, on either surface if it is about one.
   pure elemental integer function truth(values, condition)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition

      if (condition%group == 'surface') then
         truth = max(truth_in(values, condition, 'surface_1'), &
            truth_in(values, condition, 'surface_2'))
      else
         truth = truth_in(values, condition, condition%group)
      end if
   end function truth

   !> Whether a condition holds in `group`.
   pure integer function truth_in(values, condition, group) result(truth)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition
      character(*), intent(in) :: group
      real(wp) :: number
      logical, allocatable :: among(:)
      logical :: holds
      integer :: row

      truth = unknown
      row = find_key(group, condition%key, values%problem)
      if (condition%key /= '' .and. row == 0) return
      associate (slot => values%slots(row))
         select case (condition%relation)
         case ('=')
            if (.not. slot%has_value .or. any(slot%words == '?')) return
            among = has_word(condition%values, slot%words)
            if (any(among) .neqv. all(among)) return
            holds = all(among)
         case ('/=')
            if (.not. slot%has_value) return
            call read_real(trim(condition%values), number, holds)
            holds = abs(slot%reals(1) - number) > 0.0_wp
         case default
            holds = slot%is_given
            if (condition%key == '') holds = values%has_group(group)
            if (condition%key == '' .and. holds) holds = has_word( &
               group_rows(find_group(group))%problems, values%problem)
            if (condition%relation == 'without') holds = .not. holds
         end select
      end associate
      truth = merge(yes, no, holds)
   end function truth_in

   !> What is the case where a condition does not hold, and its reason: "with shape = 'smooth'".
   pure function opposite(values, condition) result(text)
      type(input_values_t), intent(in) :: values
      type(condition_t), intent(in) :: condition
      character(:), allocatable :: text
      type(condition_t) :: other

      other = condition
      select case (condition%relation)
      case ('with')
         other%relation = 'without'
      case ('without')
         other%relation = 'with'
      case ('/=')
         other%relation = '='
      case default
         if (condition%group /= 'surface') other%values = values%word_value(condition%group, &
            condition%key)
      end select
      text = joined([other])
      if (other%group == 'surface') text = 'without'//text(5:)
      if (condition%reason /= '') text = text//', '//trim(condition%reason)
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
            if (row%typical == '' .or. .not. slot%has_value) cycle
            if (.not. has_word(row%problems, values%problem)) cycle
            if (.not. any(slot%is_set)) cycle
            place = findloc(is_in_range(slot%reals, row%typical), .false., dim=1)
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

   !> The conditions of a `rule` in a row of `group`.
   pure function conditions_of(rule, group) result(conditions)
      character(*), intent(in) :: rule, group
      type(condition_t), allocatable :: conditions(:)
      character(len=len_trim(rule)), allocatable :: parts(:)
      integer :: blank, colon, i, percent

      parts = split_words(trim(rule), ',')
      allocate (conditions(size(parts)))
      do i = 1, size(parts)
         associate (part => parts(i), condition => conditions(i))
            colon = index(part//':', ':')
            blank = index(part(:colon - 1)//' ', ' ')
            condition%reason = adjustl(part(colon + 1:))
            condition%name = part(:blank - 1)
            condition%values = adjustl(part(blank:colon - 1))
            if (condition%name == 'no') then
               condition%relation = 'without'
               condition%name = condition%values
            else if (condition%values /= '') then
               blank = index(condition%values, ' ')
               condition%relation = condition%values(:blank - 1)
               condition%values = adjustl(condition%values(blank:))
            end if
            percent = index(condition%name, '%')
            condition%group = group
            condition%key = condition%name(percent + 1:)
            if (percent > 0) then
               condition%group = condition%name(:percent - 1)
               condition%name = '&'//trim(condition%group)//' '//condition%key
            else if (condition%name(1:1) == '&') then
               condition%group = trim(condition%name(2:))
               condition%key = ''
            end if
         end associate
      end do
   end function conditions_of

   !> The rules of a key for the manual: "; required with shape = 'file'"; empty: there are none.
   pure function rules_text(row) result(text)
      type(key_t), intent(in) :: row
      character(:), allocatable :: text, used

      text = joined(conditions_of(row%needed, row%group))
      used = joined(conditions_of(row%used, row%group))
      if (used == text) used = ''
      if (used /= '') used = '; only '//used
      if (text /= '') text = '; required '//text
      text = used//text
   end function rules_text

   !> Conditions as a text: "with shape = 'file'", "without film_floor" or "with moes_l /= 0".
   pure function joined(conditions) result(text)
      type(condition_t), intent(in) :: conditions(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(conditions)
         if (i > 1) text = text//' and '
         associate (condition => conditions(i))
            if (any(condition%relation == ['with   ', 'without'])) then
               text = text//trim(condition%relation)//' '//trim(condition%name)
            else
               text = text//'with '//trim(condition%key)//' '//trim(condition%relation)//' '
               if (scan(condition%values(:1), '.0123456789') == 1) then
                  text = text//trim(condition%values)
               else
                  text = text//word_list(condition%values)
               end if
            end if
         end associate
      end do
   end function joined

end module key_rules
