!> Measured heights: what is asked of a file and read from it, and what they may be, alone and
!> together, with faults in words.
!>
!> The limits lie far beyond measured surfaces; squares and quotients within them stay finite.
module measured_heights
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use height_form, only: height_sums_t, trend_t
   use kinds, only: int64, wp
   use profile, only: height_source_t
   use text, only: counted, to_text
   implicit none (type, external)
   private

   public :: height_fault, height_range_t, height_request_t, heights_t, is_height, is_position, &
      place_words, position_fault, position_range_t, scale_fault, spacing_fault

   !> What the keys of a surface say of its file.
   type :: height_request_t
      !> Its path; names of the columns of positions and heights (or the path in HDF5), or empty.
      character(:), allocatable :: file, positions, dataset
      !> Units of positions and heights, blank where the file says them.
      character(len=12) :: units(2) = ''
   end type height_request_t

   !> Heights of a file, on a uniform grid.
   type :: heights_t
      !> Heights (nx*ny) [m], x fastest; not allocated: too many to be held.
      real(wp), allocatable :: z(:)
      !> Spacing of the nodes [m]; 0: the file does not tell.
      real(wp) :: spacing(2) = 0.0_wp
      !> Path of the file; not allocated: there is none.
      character(:), allocatable :: file
      !> Checksum of the heights.
      character(len=16) :: digits = ''
      !> Their grid nx, ny (ny = 1: a profile), and their sums, for slopes and form.
      type(height_sums_t) :: sums
      !> Where all of a profile are; not allocated: in z.
      class(height_source_t), allocatable :: source
      !> What was subtracted from them, and will be from those of the source.
      type(trend_t) :: trend
   end type heights_t

   !> Largest height and position [m].
   real(wp), parameter :: largest_height = 1.0e3_wp, largest_position = 1.0e9_wp
   !> Spacing of the nodes [m].
   real(wp), parameter :: least_spacing = 1.0e-15_wp, largest_spacing = 1.0e6_wp
   !> Metres in the unit of a dataset.
   real(wp), parameter :: least_scale = 1.0e-30_wp, largest_scale = 1.0e30_wp

   !> A value this many ranges of all others from the next one is likely a missing point.
   real(wp), parameter :: far = 10.0_wp

   !> The lowest height, the next above it, and the mark of the first; of both signs.
   type :: height_range_t
      real(wp), private :: lowest(2) = huge(1.0_wp), next(2) = huge(1.0_wp)
      integer(int64), private :: marks(2) = 0_int64
   contains
      procedure :: add => add_heights, find_fault => find_height_fault
   end type height_range_t

   !> Largest error of a position, in spacings, that still counts as uniform.
   real(wp), parameter :: max_uneven = 1.0e-3_wp

   !> The spacings that the positions so far allow, each within `max_uneven` of its place.
   type :: position_range_t
      !> How many positions there were.
      integer(int64) :: count = 0_int64
      !> They fall.
      logical :: falls = .false.
      real(wp), private :: first = 0.0_wp, last = 0.0_wp
      real(wp), private :: low = 0.0_wp, high = huge(1.0_wp)
      !> Marks of the positions that set the bounds.
      integer(int64), private :: low_mark = 0_int64, high_mark = 0_int64
   contains
      procedure :: add => add_position, find_fault => find_position_fault, distance
   end type position_range_t

contains

   !> Whether `z` [m] can be a height: finite, not too large, zero or with all digits of a number.
   pure elemental logical function is_height(z)
      real(wp), intent(in) :: z

      is_height = lies_within(abs(z), tiny(z), largest_height) .or. lies_within(z, 0.0_wp, 0.0_wp)
   end function is_height

   !> Whether `x` [m] can be a position.
   pure elemental logical function is_position(x)
      real(wp), intent(in) :: x

      is_position = lies_within(abs(x), 0.0_wp, largest_position)
   end function is_position

   !> Whether a value is finite and in [lowest, highest]; comparing NaN would trap.
   pure elemental logical function lies_within(value, lowest, highest)
      real(wp), intent(in) :: value, lowest, highest

      lies_within = .false.
      if (ieee_is_finite(value)) lies_within = value >= lowest .and. value <= highest
   end function lies_within

   !> "found ..., expected ..." for a number that cannot be a height [m].
   pure function height_fault(z) result(fault)
      real(wp), intent(in) :: z
      character(:), allocatable :: fault

      if (ieee_is_nan(z)) then
         fault = 'found a height that is no number (a gap), expected heights without gaps'
      else if (abs(z) > largest_height) then
         fault = 'found a height of '//shown(z)//' m, expected at most ' &
            //to_text(nint(largest_height))//' m'
      else
         fault = 'found a height of '//shown(z)//' m, expected 0 or at least '//to_text(tiny(z), &
            3)//' m'
      end if
   end function height_fault

   !> The same for a number that cannot be a position [m].
   pure function position_fault(x) result(fault)
      real(wp), intent(in) :: x
      character(:), allocatable :: fault

      fault = 'found a position of '//shown(x)//' m, expected at most ' &
         //to_text(nint(largest_position))//' m'
   end function position_fault

   !> The same for the distance of neighbouring nodes [m]; empty if it can be one.
   pure function spacing_fault(spacing) result(fault)
      real(wp), intent(in) :: spacing
      character(:), allocatable :: fault

      fault = ''
      if (.not. lies_within(spacing, least_spacing, largest_spacing)) fault = &
         'found a spacing of '//shown(spacing)// &
         ' m, expected '//to_text(least_spacing, 2)//' to '//to_text(nint(largest_spacing))//' m'
   end function spacing_fault

   !> The same for `si_scale`, metres in the unit of a dataset; below 0 heights become depths.
   pure function scale_fault(scale) result(fault)
      real(wp), intent(in) :: scale
      character(:), allocatable :: fault

      fault = ''
      if (.not. lies_within(abs(scale), least_scale, largest_scale)) fault = &
         'found '//shown(scale)//', expected '//to_text(least_scale, 2) &
         //' to '//to_text(largest_scale, 2)//', metres in one unit of the dataset'
   end function scale_fault

   !> A number, or infinity in the words of the messages.
   pure function shown(value)
      real(wp), intent(in) :: value
      character(:), allocatable :: shown

      shown = to_text(value, 4)
      if (.not. (ieee_is_finite(value) .or. ieee_is_nan(value))) shown = trim(merge('-Infinity', &
         'Infinity ', value < 0.0_wp))
   end function shown

   !> Where node `number` of an area lies, in brackets; empty for a profile.
   pure function place_words(number, grid) result(words)
      integer(int64), intent(in) :: number, grid(2)
      character(:), allocatable :: words

      words = ''
      if (grid(2) > 1) words = ' (node '//to_text(modulo(number - 1, grid(1)) + 1)//' in x, '// &
         to_text((number - 1)/grid(1) + 1)//' in y)'
   end function place_words

   !> Adds the next heights; `mark` says where the first one stands, and the others count on.
   pure subroutine add_heights(self, z, mark)
      class(height_range_t), intent(inout) :: self
      real(wp), intent(in) :: z(:)
      integer(int64), intent(in) :: mark
      real(wp) :: value
      integer :: i, k

      do i = 1, size(z)
         if (z(i) > self%next(1) .and. -z(i) > self%next(2)) cycle   ! changes nothing
         do k = 1, 2
            value = merge(z(i), -z(i), k == 1)
            if (value < self%lowest(k)) then
               self%next(k) = self%lowest(k)
               self%lowest(k) = value
               self%marks(k) = mark + i - 1
            else if (value > self%lowest(k)) then
               self%next(k) = min(self%next(k), value)
            end if
         end do
      end do
   end subroutine add_heights

   !> "found ..., expected ..." where two or more heights cannot be those of a surface, or do not
   !> differ though they `must_vary`, else empty; and the mark of the height that cannot be one.
   pure subroutine find_height_fault(self, must_vary, fault, mark)
      class(height_range_t), intent(in) :: self
      logical, intent(in) :: must_vary
      character(:), allocatable, intent(out) :: fault
      integer(int64), intent(inout) :: mark
      real(wp) :: others
      integer :: k

      fault = ''
      if (.not. self%next(1) < huge(1.0_wp)) then
         if (must_vary) fault = 'found heights that are all '//to_text(self%lowest(1))// &
            ', expected those of a surface'
         return
      end if
      do k = 1, 2
         others = -(self%lowest(3 - k) + self%next(k))
         if (others <= 0.0_wp .or. self%next(k) - self%lowest(k) <= far*others) cycle
         mark = self%marks(k)
         fault = 'found '//to_text(merge(self%lowest(k), -self%lowest(k), k == 1))// &
            ', far from all other heights and likely the mark of a missing point, expected '// &
            'heights without gaps'
      end do
   end subroutine find_height_fault

   !> Adds the next position [m]; `mark` says where it stands.
   pure subroutine add_position(self, x, mark)
      class(position_range_t), intent(inout) :: self
      real(wp), intent(in) :: x
      integer(int64), intent(in) :: mark
      real(wp) :: distance, high, low

      if (self%count == 0) self%first = x
      if (self%count == 1) self%falls = x < self%first
      self%last = x
      self%count = self%count + 1
      if (self%count == 1) return
      distance = merge(self%first - x, x - self%first, self%falls)
      low = distance/(self%count - 1 + max_uneven)
      high = distance/(self%count - 1 - max_uneven)
      if (low > self%low) then
         self%low = low
         self%low_mark = mark
      end if
      if (high < self%high) then
         self%high = high
         self%high_mark = mark
      end if
   end subroutine add_position

   !> Distance of neighbouring positions [m], of two or more; positive if they rise or fall.
   pure real(wp) function distance(self)
      class(position_range_t), intent(in) :: self

      distance = (self%last - self%first)/(self%count - 1)
      if (self%falls) distance = -distance
   end function distance

   !> "found ..., expected ..." where the positions are not those of a uniform grid, or fall though
   !> they `must_rise`, else empty; and the mark of the one that does not fit the others, or 0.
   pure subroutine find_position_fault(self, must_rise, fault, mark)
      class(position_range_t), intent(in) :: self
      logical, intent(in) :: must_rise
      character(:), allocatable, intent(out) :: fault
      integer(int64), intent(out) :: mark
      real(wp) :: spacing

      mark = 0_int64
      if (self%count < 2) then
         fault = 'found '//counted(int(self%count), 'row')//' of numbers, expected at least 2'
         return
      end if
      spacing = self%distance()
      if (.not. spacing > 0.0_wp) then
         fault = 'found positions that neither rise nor fall, expected those of a uniform grid'
      else
         if (spacing > self%high) mark = self%high_mark
         if (spacing < self%low) mark = self%low_mark
         fault = spacing_fault(spacing)
         if (mark > 0) fault = 'found uneven positions, expected a uniform grid'
      end if
      if (self%falls .and. must_rise) fault = 'found falling positions, expected rising ones'
   end subroutine find_position_fault

end module measured_heights
