!> The values of one namelist entry, cut into pieces; logicals. (Numbers: module number_text.)
module namelist_values
   use, intrinsic :: iso_fortran_env, only: int64
   use number_text, only: read_integer
   use text, only: to_lower, to_text
   implicit none (type, external)
   private

   public :: piece_t, split_values, read_logical

   !> One value as written; of a string the content without its quotes.
   type :: piece_t
      character(:), allocatable :: text
      logical :: is_string = .false.
   end type piece_t

   !> Most values of one key.
   integer, parameter, public :: max_values = 2000
   !> Room for values that an entry begins with.
   integer, parameter :: few = 4

contains

   !> Cuts `values` at blanks and commas; expands repeat counts as in 3*0.1.
   !>
   !> `problem` is allocated, with the words after "found", if the text is not a list of values.
   subroutine split_values(values, pieces, problem)
      character(*), intent(in) :: values
      type(piece_t), allocatable, intent(out) :: pieces(:)
      character(:), allocatable, intent(out) :: problem
      type(piece_t), allocatable :: list(:), longer(:)
      type(piece_t) :: piece
      integer :: position, blanks, count, repeats
      logical :: comma_before

      allocate (list(few))
      count = 0
      comma_before = .true.
      position = 1
      do
         blanks = verify(values(position:), ' ') - 1
         if (blanks < 0) exit
         position = position + blanks
         if (values(position:position) == ',') then
            if (comma_before) then
               problem = 'an empty value before a comma (a null of the Fortran standard, not '// &
                  'taken here)'
               return
            end if
            comma_before = .true.
            position = position + 1
            cycle
         end if
         comma_before = .false.
         call read_repeats(values, position, repeats)
         call read_piece(values, position, piece, problem)
         if (allocated(problem)) return
         if (scan(values(position:min(position, len(values))), ' ,') == 0 &
            .and. position <= len(values)) then
            problem = 'two values without a comma or blank between them'
            return
         end if
         if (repeats < 1 .or. count + repeats > max_values) then
            problem = 'a repeat count or list outside 1 to ' // to_text(max_values) // ' values'
            return
         end if
         if (count + repeats > size(list)) then
            allocate (longer(2*(count + repeats)))
            longer(:count) = list(:count)
            call move_alloc(longer, list)
         end if
         list(count + 1:count + repeats) = piece
         count = count + repeats
      end do
      if (count == 0) problem = 'an empty value'
      pieces = list(:count)
   end subroutine split_values

   !> Reads the `n*` of a repeated value at `position`; repeats = 1 without, -1 if n is too large.
   subroutine read_repeats(values, position, repeats)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      integer, intent(out) :: repeats
      integer :: digits
      integer(int64) :: count
      logical :: good

      repeats = 1
      digits = verify(values(position:), '0123456789') - 1
      if (digits < 1) return
      if (values(position + digits:position + digits) /= '*') return
      repeats = -1
      call read_integer(values(position:position + digits - 1), count, good)
      if (good .and. count <= max_values) repeats = int(count)
      position = position + digits + 1
   end subroutine read_repeats

   !> Reads the string or the bare value at `position`. Problem: nothing there (after `n*`).
   subroutine read_piece(values, position, piece, problem)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(:), allocatable, intent(out) :: problem
      character(len=1) :: mark
      integer :: length

      mark = ' '
      if (position <= len(values)) mark = values(position:position)
      if (mark == ' ' .or. mark == ',') then
         problem = 'a repeat count without a value (a null of the Fortran standard, not taken here)'
      else if (mark == "'" .or. mark == '"') then
         call read_string(values, position, piece)
      else
         length = scan(values(position:), ' ,''"') - 1
         if (length < 0) length = len(values) - position + 1
         piece%text = values(position:position + length - 1)
         position = position + length
      end if
   end subroutine read_piece

   !> Reads the string at `position`; a doubled quote inside stands for one.
   subroutine read_string(values, position, piece)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(:), allocatable :: content
      character(len=1) :: mark
      integer :: length

      mark = values(position:position)
      allocate (character(len=len(values)) :: content)
      length = 0
      position = position + 1
      do while (position <= len(values))
         if (values(position:position) == mark) then
            if (position == len(values)) exit
            if (values(position + 1:position + 1) /= mark) exit
            position = position + 1
         end if
         length = length + 1
         content(length:length) = values(position:position)
         position = position + 1
      end do
      position = position + 1
      piece%is_string = .true.
      piece%text = content(:length)
   end subroutine read_string

   !> Reads a logical in any case: true, false, t, f, with a point before it or on both sides.
   subroutine read_logical(piece, value, good)
      type(piece_t), intent(in) :: piece
      logical, intent(out) :: value, good

      value = .false.
      good = .not. piece%is_string
      if (.not. good) return
      select case (to_lower(piece%text))
      case ('.true.', 'true', '.true', '.t.', '.t', 't')
         value = .true.
      case ('.false.', 'false', '.false', '.f.', '.f', 'f')
         value = .false.
      case default
         good = .false.
      end select
   end subroutine read_logical

end module namelist_values
