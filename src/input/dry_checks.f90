!> What a dry case must fulfil beyond its single keys: one parabola, an open domain that holds its
!> contact, a grid that sees its waves; and notes on what the user should know.
module dry_checks
   use constants, only: pi
   use domain_border, only: recommended_room
   use dry_case, only: dry_case_t
   use findings, only: findings_t
   use hertz, only: line_half_width, point_radius
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: add_note, check_parabola, check_waves, finest_wave, has_shape, is_periodic

   character(len=9), parameter :: groups(2) = ['surface_1', 'surface_2']
   !> Nodes in the finest wave below which the program says so; fewer than the second show another
   !> wave.
   real(wp), parameter, public :: fewest_nodes = 8.0_wp
   real(wp), parameter :: least_nodes = 2.0_wp
   !> Share of a node that rounding may take.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> Images of a parabola on either side that are summed.
   integer, parameter :: images = 60

contains

   !> True if the surface `group` has the shape `word`.
   pure function has_shape(values, group, word)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, word
      logical :: has_shape
      type(value_t) :: shape

      shape = values%slot(group, 'shape')
      has_shape = .false.
      if (shape%has_value) has_shape = any(shape%words == word)
   end function has_shape

   !> Whether the domain is periodic; where it is not said, a parabola is not.
   pure function is_periodic(values)
      type(input_values_t), intent(in) :: values
      logical :: is_periodic
      type(value_t) :: slot

      slot = values%slot('domain', 'periodic')
      is_periodic = .not. (has_shape(values, groups(1), 'parabola') .or. has_shape(values, &
         groups(2), 'parabola'))
      if (slot%has_value) is_periodic = slot%logical
   end function is_periodic

   !> Findings about a parabola of `radius` [m]: there are two; the open domain ends inside its
   !> contact. On a periodic domain a note: what the images do.
   subroutine check_parabola(values, radius, dry, findings)
      type(input_values_t), intent(in) :: values
      real(wp), intent(in) :: radius
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      logical :: is_one(2), is_smooth(2)
      integer :: i

      do i = 1, 2
         is_one(i) = has_shape(values, groups(i), 'parabola')
         is_smooth(i) = has_shape(values, groups(i), 'smooth')
      end do
      if (all(is_one)) then
         call findings%add(values%line_of(groups(2), 'shape'), groups(2), 'shape', &
            'found a second parabola, expected one: the ' &
            // 'reduced radius is that of both bodies')
      else if (any(is_one) .and. dry%is_periodic) then
         call add_note(dry, note_on_images(dry, radius))
      else if (any(is_one) .and. any(is_smooth)) then
         call check_size(values, radius, dry, findings)
      end if
   end subroutine check_parabola

   !> Finds an open domain that is shorter than the contact of Hertz under the largest load (what
   !> yields is wider still).
   subroutine check_size(values, radius, dry, findings)
      type(input_values_t), intent(in) :: values
      real(wp), intent(in) :: radius
      type(dry_case_t), intent(in) :: dry
      type(findings_t), intent(inout) :: findings
      real(wp) :: growth, length, needed, width
      character(:), allocatable :: key
      logical :: is_line

      is_line = dry%grid%ny == 1
      length = merge(dry%lengths(1), minval(dry%lengths), is_line)
      growth = 0.0_wp
      if (allocated(dry%loads%separation)) then
         width = 2.0_wp*sqrt(max(0.0_wp, maxval(dry%loads%separation))*radius)
      else
         width = 2.0_wp*half_width(dry, radius)
         ! A mean pressure loads a longer domain more.
         if (values%is_given('load', 'mean_pressure')) growth = merge(1.0_wp/2.0_wp, &
            2.0_wp/3.0_wp, is_line)
      end if
      if (width <= length) return
      needed = length*(recommended_room*width/length)**(1.0_wp/(1.0_wp - growth))
      key = 'length'
      if (.not. is_line) key = trim(merge('length_x', 'length_y', dry%lengths(1) <= dry%lengths(2)))
      call findings%add(values%line_of('domain', key), 'domain', key, &
         'found ' // to_text(length) // ' m, which ends inside the ' &
         // 'contact of ' // to_text(width, 3) // ' m (Hertz), expected about '// &
            '' // to_text(needed, 2) // ' m')
   end subroutine check_size

   !> Half-width or radius [m] of the contact of Hertz under the largest load.
   pure function half_width(dry, radius)
      type(dry_case_t), intent(in) :: dry
      real(wp), intent(in) :: radius
      real(wp) :: half_width
      real(wp) :: pressure

      pressure = maxval(dry%loads%mean_pressure)
      if (dry%grid%ny == 1) then
         half_width = line_half_width(pressure*dry%lengths(1), radius, dry%reduced_modulus)
      else
         half_width = point_radius(pressure*dry%lengths(1)*dry%lengths(2), radius, &
            dry%reduced_modulus)
      end if
   end function half_width

   !> By how much the images of a periodic parabola raise its largest pressure. Near the contact
   !> they bend the surface like a larger curvature 1/R + (P/(pi E')) sum 1/d^3, d the distances of
   !> the images; of a line 1/R + 4 pi w/(3 E' L^2).
   pure function note_on_images(dry, radius) result(note)
      type(dry_case_t), intent(in) :: dry
      real(wp), intent(in) :: radius
      character(:), allocatable :: note
      real(wp) :: bending, load, rise
      integer :: i, j

      note = 'the parabola is repeated with the period, which changes its contact'
      if (.not. allocated(dry%loads%mean_pressure)) return
      load = maxval(dry%loads%mean_pressure)*dry%lengths(1)
      if (dry%grid%ny == 1) then
         bending = 4.0_wp*pi*load/(3.0_wp*dry%reduced_modulus*dry%lengths(1)**2)
         rise = (1.0_wp + radius*bending)**(1.0_wp/2.0_wp) - 1.0_wp
      else
         bending = 0.0_wp
         do j = -images, images
            do i = -images, images
               if (i /= 0 .or. j /= 0) bending = bending + hypot(i*dry%lengths(1), &
                  j*dry%lengths(2))**(-3)
            end do
         end do
         bending = bending*load*dry%lengths(2)/(pi*dry%reduced_modulus)
         rise = (1.0_wp + radius*bending)**(2.0_wp/3.0_wp) - 1.0_wp
      end if
      note = 'the parabola is repeated with the period: its images raise the largest pressure '// &
         'by about ' &
             // to_text(100.0_wp*rise, 2) // ' % over that of Hertz (periodic = .false. has none)'
   end function note_on_images

   !> Finds waves of a surface with fewer than two nodes. A note where they have few.
   subroutine check_waves(values, dry, findings)
      type(input_values_t), intent(in) :: values
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      real(wp) :: spacing, wave, finest
      character(:), allocatable :: key
      integer :: i

      finest = huge(1.0_wp)
      do i = 1, 2
         key = 'wavelength'
         if (has_shape(values, groups(i), 'synthetic')) key = 'wavelength_short'
         spacing = dry%lengths(1)/dry%grid%nx
         if (key == 'wavelength_short' .and. dry%grid%ny > 1) spacing = max(spacing, &
            dry%lengths(2)/dry%grid%ny)
         wave = finest_wave(values, groups(i))
         if (key == 'wavelength_short' .and. .not. values%is_given(groups(i), key)) wave = &
            least_nodes*spacing
         if (wave < (least_nodes - rounding)*spacing) call findings%add(values%line_of(groups(i), &
            key), groups(i), key, 'found ' &
            // to_text(wave) // ' m, expected at least two nodes a wave, ' // to_text(2.0_wp &
               *spacing, 3) // ' m, or more intervals')
         if (wave < huge(1.0_wp)) finest = min(finest, wave/spacing)
      end do
      if (finest < fewest_nodes - rounding .and. findings%count == 0) call add_note(dry, &
         'the finest waves of the surface have ' &
         // to_text(finest, 2) // ' nodes, of ' // to_text(nint(fewest_nodes)) &
            // ' that are needed for its contact area')
   end subroutine check_waves

   !> The shortest wave that the keys of a surface give [m]; huge: none.
   pure function finest_wave(values, group) result(wave)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      real(wp) :: wave
      type(value_t) :: slot

      wave = huge(1.0_wp)
      slot = values%slot(group, trim(merge('wavelength_short', 'wavelength      ', &
         has_shape(values, group, 'synthetic'))))
      if (slot%is_given .and. slot%has_value) wave = minval(slot%reals)
   end function finest_wave

   !> Adds a sentence to the notes.
   pure subroutine add_note(dry, sentence)
      type(dry_case_t), intent(inout) :: dry
      character(*), intent(in) :: sentence

      if (allocated(dry%note)) then
         dry%note = dry%note // '; ' // sentence
      else
         dry%note = sentence
      end if
   end subroutine add_note

end module dry_checks
