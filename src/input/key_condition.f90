!> The rules of the key table as text: with what a key is used, and with what it must be given.
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
module key_condition
   use key_row, only: key_row_t, split_words, word_list
   implicit none (type, external)
   private

   public :: condition_t, conditions_of, name_of, rules_text, shown

   !> One condition.
   type :: condition_t
      !> 'with' or 'without' a key or group, or '=' or '/='.
      character(len=8) :: relation
      !> The group, 'surface' for either surface; the key, empty for the group as a whole.
      character(len=20) :: group, key
      !> What follows '=' or '/='.
      character(len=80) :: values = ''
      !> What follows the colon.
      character(len=80) :: reason = ''
      !> True: the rule is that of a key of another group.
      logical :: is_elsewhere
   end type condition_t

contains

   !> The conditions of a `rule` in a row of `group`.
   pure function conditions_of(rule, group) result(conditions)
      character(*), intent(in) :: rule, group
      type(condition_t), allocatable :: conditions(:)
      character(len=len(rule)), allocatable :: parts(:)
      integer :: i

      parts = split_words(rule, ',')
      allocate (conditions(size(parts)))
      do i = 1, size(parts)
         conditions(i) = new_condition(trim(parts(i)), group)
      end do
   end function conditions_of

   !> The condition that `text` means in a row of `group`.
   pure function new_condition(text, group) result(condition)
      character(*), intent(in) :: text, group
      type(condition_t) :: condition
      character(len=len(condition%values)) :: name
      integer :: blank, colon, percent

      colon = index(text//':', ':')
      condition%reason = adjustl(text(min(colon + 1, len(text) + 1):))
      blank = index(text(:colon - 1)//' ', ' ')
      name = text(:blank - 1)
      condition%values = adjustl(text(blank:colon - 1))
      condition%relation = 'with'
      if (name == 'no') then
         condition%relation = 'without'
         name = condition%values
      else if (condition%values /= '') then
         condition%relation = condition%values(:index(condition%values, ' ') - 1)
         condition%values = adjustl(condition%values(index(condition%values, ' '):))
      end if
      percent = index(name, '%')
      condition%is_elsewhere = percent > 0
      condition%group = group
      if (percent > 0) condition%group = name(:percent - 1)
      condition%key = name(percent + 1:)
      if (name(1:1) == '&') then
         condition%group = name(2:)
         condition%key = ''
      end if
   end function new_condition

   !> The rules of a key for the manual: "; required with shape = 'file'"; empty: there are none.
   pure function rules_text(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text, used

      text = joined(conditions_of(row%needed, row%group))
      used = joined(conditions_of(row%used, row%group))
      if (used == text) used = ''
      if (used /= '') used = '; only '//used
      if (text /= '') text = '; required '//text
      text = used//text
   end function rules_text

   !> Conditions as a text.
   pure function joined(conditions) result(text)
      type(condition_t), intent(in) :: conditions(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(conditions)
         if (i > 1) text = text//' and '
         text = text//phrase(conditions(i))
      end do
   end function joined

   !> A condition as "with shape = 'file'", "without film_floor" or "with moes_l /= 0".
   pure function phrase(condition) result(text)
      type(condition_t), intent(in) :: condition
      character(:), allocatable :: text

      select case (condition%relation)
      case ('with', 'without')
         text = trim(condition%relation)//' '//name_of(condition)
      case ('=')
         text = 'with '//trim(condition%key)//' = '//shown(condition%values)
      case default
         text = 'with '//trim(condition%key)//' /= '//trim(condition%values)
      end select
   end function phrase

   !> What a condition is about: "film_floor", "&accuracy target" or "&moes".
   pure function name_of(condition) result(name)
      type(condition_t), intent(in) :: condition
      character(:), allocatable :: name

      name = trim(condition%key)
      if (name == '') name = '&'//trim(condition%group)
      if (condition%is_elsewhere) name = '&'//trim(condition%group)//' '//name
   end function name_of

   !> Words as in a namelist.
   pure function shown(words) result(text)
      character(*), intent(in) :: words
      character(:), allocatable :: text

      text = trim(words)
      if (text(1:1) /= '.') text = word_list(text)
   end function shown

end module key_condition
