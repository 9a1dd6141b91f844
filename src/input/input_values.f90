!> The values of one case, one slot for each row of the key table, and the findings about them.
module input_values
   use findings, only: findings_t
   use input_keys, only: find_group, find_key, group_rows, key_rows
   use key_row, only: expected_value, lubricated
   use kinds, only: wp
   use solver_settings, only: word_length
   implicit none (type, external)
   private

   public :: value_t, input_values_t

   !> The value of one key.
   type :: value_t
      !> True if the user gave it (also when it could not be read).
      logical :: is_given = .false.
      !> True if there is a value, from the user or from the table.
      logical :: has_value = .false.
      !> Line of the key in the file; 0: not given.
      integer :: line = 0
      real(wp), allocatable :: reals(:)
      integer :: integer = 0
      logical :: logical = .false.
      !> Words; of a logical '.true.' or '.false.'.
      character(len=word_length), allocatable :: words(:)
      character(:), allocatable :: text
      !> What the text of an array of numbers seems to mean, if not these numbers; else nothing.
      character(:), allocatable :: hint
      !> Elements that the user has set (arrays).
      logical, allocatable :: is_set(:)
   end type value_t

   !> The values of all keys, in the order of `key_rows`, and where the groups are. Slot 0, never
   !> filled, stands for keys that the problem does not have.
   type :: input_values_t
      type(value_t) :: slots(0:size(key_rows))
      !> Line of each group of `group_rows`; 0: not in the file.
      integer :: group_lines(size(group_rows)) = 0
      !> The problem, as far as it could be read; else the lubricated one.
      character(len=word_length) :: problem = lubricated
      !> Last line of the file, where missing groups are reported.
      integer :: last_line = 0
      !> What is wrong with the file.
      type(findings_t) :: findings
      !> Whether the height file of each surface was read, or could not be.
      logical :: has_read(2) = .false.
   contains
      procedure :: slot, real_value, integer_value, logical_value, word_value, text_value, &
         is_given, has_value, has_group, line_of, give, refuse, refuse_missing, refuse_unused
   end type input_values_t

contains

   !> The slot of a key of the table.
   pure function slot(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      type(value_t) :: slot

      slot = self%slots(find_key(group, key, self%problem))
   end function slot

   !> The first real value of a key; `default` or 0 if there is none.
   pure real(wp) function real_value(self, group, key, default) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      real(wp), intent(in), optional :: default

      value = 0.0_wp
      if (present(default)) value = default
      associate (slot => self%slots(find_key(group, key, self%problem)))
         if (slot%has_value) value = slot%reals(1)
      end associate
   end function real_value

   !> The integer of a key; 0 if there is none.
   pure integer function integer_value(self, group, key) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      value = self%slots(find_key(group, key, self%problem))%integer
   end function integer_value

   !> Whether a key is true; false if it has no value.
   pure logical function logical_value(self, group, key) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      value = self%slots(find_key(group, key, self%problem))%logical
   end function logical_value

   !> The first word of a key; '?' if there is none.
   pure function word_value(self, group, key) result(word)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      character(len=word_length) :: word

      word = '?'
      associate (slot => self%slots(find_key(group, key, self%problem)))
         if (slot%has_value) word = slot%words(1)
      end associate
   end function word_value

   !> The text of a key; empty if there is none.
   pure function text_value(self, group, key) result(text)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      character(:), allocatable :: text

      text = self%slots(find_key(group, key, self%problem))%text
   end function text_value

   !> True if the user gave the key, also with a value that could not be read.
   pure logical function is_given(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      is_given = self%slots(find_key(group, key, self%problem))%is_given
   end function is_given

   !> True if the key has a value, given or default.
   pure logical function has_value(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      has_value = self%slots(find_key(group, key, self%problem))%has_value
   end function has_value

   !> True if the group is in the file.
   pure logical function has_group(self, group)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group

      has_group = self%group_lines(find_group(group)) > 0
   end function has_group

   !> Line to report for a key: its own, else that of its group, else the last of the file.
   pure integer function line_of(self, group, key) result(line)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      line = 0
      if (len_trim(key) > 0) line = self%slots(find_key(group, key, self%problem))%line
      if (line == 0) line = self%group_lines(find_group(group))
      if (line == 0) line = self%last_line
   end function line_of

   !> Gives a key a number, as if it were given at the line of the key `source` of its group.
   subroutine give(self, group, key, source, value)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key, source
      real(wp), intent(in) :: value
      integer :: line

      line = self%line_of(group, source)
      if (find_key(group, key, self%problem) == 0) return
      associate (slot => self%slots(find_key(group, key, self%problem)))
         slot%is_given = .true.
         slot%has_value = .true.
         slot%line = line
         slot%reals = [value]
      end associate
   end subroutine give

   !> Adds a finding at the line of a key; without a key at that of the group.
   subroutine refuse(self, group, key, message)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key, message

      call self%findings%add(self%line_of(group, key), group, key, message)
   end subroutine refuse

   !> Adds: the key is not there but needed; `reason`, if not empty, says by what.
   subroutine refuse_missing(self, group, key, reason)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key
      character(*), intent(in), optional :: reason
      character(:), allocatable :: message

      message = 'missing, expected ' // expected_value(key_rows(find_key(group, key, &
         self%problem)))
      if (present(reason)) message = trim(message // ' ' // reason)
      call self%findings%add(self%line_of(group, ''), group, key, message)
   end subroutine refuse_missing

   !> Adds, if the key is given: it is not used; `reason` says why.
   subroutine refuse_unused(self, group, key, reason)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key, reason

      if (self%is_given(group, key)) call self%refuse(group, key, &
         'not used ' // reason // ': remove it')
   end subroutine refuse_unused

end module input_values
