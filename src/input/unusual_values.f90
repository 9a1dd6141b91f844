!> What is said of values without being wrong: those that are possible but that no usual contact
!> has are most often numbers in another unit.
module unusual_values
   use input_keys, only: key_rows
   use input_values, only: input_values_t
   use key_range, only: is_typical
   use key_row, only: has_word
   use kinds, only: wp
   use quantity_text, only: number_text
   implicit none (type, external)
   private

   public :: unusual_t, find_unusual

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

   !> The given keys of `values` outside the typical range of their row of the key table, one entry
   !> each, with the first value that is.
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
            if (question == '') question = '; is the unit right?'
            unusual = [unusual, unusual_t(slot%line, '&'//trim(row%group)//' '//trim(row%key) &
               //': '//number_text(slot%reals(place), 3)//' '//trim(row%unit) &
               //' is unusual, typical is '//trim(row%typical)//' '//trim(row%unit), &
               question)]
         end associate
      end do
   end function find_unusual

end module unusual_values
