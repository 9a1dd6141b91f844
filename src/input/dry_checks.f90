!> What a dry case must fulfil beyond its single keys: one parabola, an open domain that holds its
!> contact, a grid that sees its waves; and notes on what the user should know.
module dry_checks
   use constants, only: pi
   use domain_border, only: recommended_room
   use dry_case, only: dry_case_t
   use hertz, only: line_half_width, point_radius
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use surface_keys, only: has_shape, surfaces
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: check_parabola, check_waves, finest_wave

   !> Nodes in the finest wave below which the program says so; fewer than the second show another
   !> wave.
   real(wp), parameter, public :: min_nodes = 8.0_wp
   real(wp), parameter :: least_nodes = 2.0_wp
   !> Share of a node that rounding may take.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> Images of a parabola on either side that are summed.
   integer, parameter :: images = 60

contains

   !> Findings about a parabola: there are two; the open domain ends inside its contact. On a
   !> periodic domain a note: what the images do.
   subroutine check_parabola(dry)
      type(dry_case_t), intent(inout) :: dry
      logical :: is_one(2)

      is_one = has_shape(dry%values, surfaces, 'parabola')
      if (all(is_one)) then
         call dry%values%refuse(surfaces(2), 'shape', 'found a second parabola, expected one: '// &
            'the reduced radius is that of both bodies')
      else if (any(is_one) .and. dry%is_periodic) then
         call add_sentence(dry%note, note_on_images(dry))
      else if (any(is_one) .and. any(has_shape(dry%values, surfaces, 'smooth'))) then
         call check_size(dry)
      end if
   end subroutine check_parabola

   !> Finds an open domain that is shorter than the contact of Hertz under the largest load (what
   !> yields is wider still).
   subroutine check_size(dry)
      type(dry_case_t), intent(inout) :: dry
      real(wp) :: growth, length, needed, width
      character(:), allocatable :: key
      logical :: is_line

      is_line = dry%grid%ny == 1
      length = merge(dry%lengths(1), minval(dry%lengths), is_line)
      growth = 0.0_wp
      if (allocated(dry%loads%separation)) then
         width = 2.0_wp*sqrt(max(0.0_wp, maxval(dry%loads%separation))*dry%radius)
      else
         width = 2.0_wp*half_width(dry)
         ! A mean pressure loads a longer domain more.
         if (dry%values%is_given('load', 'mean_pressure')) growth = merge(1.0_wp/2.0_wp, &
            2.0_wp/3.0_wp, is_line)
      end if
      if (width <= length) return
      needed = length*(recommended_room*width/length)**(1.0_wp/(1.0_wp - growth))
      key = 'length'
      if (.not. is_line) key = trim(merge('length_x', 'length_y', dry%lengths(1) <= dry%lengths(2)))
      call dry%values%refuse('domain', key, 'found ' // to_text(length) &
         // ' m, which ends inside the contact of ' // to_text(width, 3) &
         // ' m (Hertz), expected about ' // to_text(needed, 2) // ' m')
   end subroutine check_size

   !> Half-width or radius [m] of the contact of Hertz under the largest load.
   pure function half_width(dry)
      type(dry_case_t), intent(in) :: dry
      real(wp) :: half_width
      real(wp) :: pressure

      pressure = maxval(dry%loads%mean_pressure)
      if (dry%grid%ny == 1) then
         half_width = line_half_width(pressure*dry%lengths(1), dry%radius, dry%reduced_modulus)
      else
         half_width = point_radius(pressure*dry%lengths(1)*dry%lengths(2), dry%radius, &
            dry%reduced_modulus)
      end if
   end function half_width

   !> By how much the images of a periodic parabola raise its largest pressure. Near the contact
   !> they bend the surface like a larger curvature 1/R + (P/(pi E')) sum 1/d^3, d the distances of
   !> the images; of a line 1/R + 4 pi w/(3 E' L^2).
   pure function note_on_images(dry) result(note)
      type(dry_case_t), intent(in) :: dry
      character(:), allocatable :: note
      real(wp) :: bending, load, rise
      integer :: i, j

      note = 'the parabola is repeated with the period, which changes its contact'
      if (.not. allocated(dry%loads%mean_pressure)) return
      load = maxval(dry%loads%mean_pressure)*dry%lengths(1)
      if (dry%grid%ny == 1) then
         bending = 4.0_wp*pi*load/(3.0_wp*dry%reduced_modulus*dry%lengths(1)**2)
         rise = (1.0_wp + dry%radius*bending)**(1.0_wp/2.0_wp) - 1.0_wp
      else
         bending = 0.0_wp
         do j = -images, images
            do i = -images, images
               if (i /= 0 .or. j /= 0) bending = bending + hypot(i*dry%lengths(1), &
                  j*dry%lengths(2))**(-3)
            end do
         end do
         bending = bending*load*dry%lengths(2)/(pi*dry%reduced_modulus)
         rise = (1.0_wp + dry%radius*bending)**(2.0_wp/3.0_wp) - 1.0_wp
      end if
      note = 'the parabola is repeated with the period: its images raise the largest pressure '// &
         'by about ' // to_text(100.0_wp*rise, 2) // ' % over that of Hertz '// &
         '(periodic = .false. has none)'
   end function note_on_images

   !> Finds waves of a surface with fewer than two nodes. A note where they have few.
   subroutine check_waves(dry)
      type(dry_case_t), intent(inout) :: dry
      real(wp) :: spacing, wave, finest
      character(:), allocatable :: key
      integer :: i

      finest = huge(1.0_wp)
      do i = 1, size(surfaces)
         key = 'wavelength'
         spacing = dry%lengths(1)/dry%grid%nx
         wave = finest_wave(dry%values, surfaces(i))
         if (has_shape(dry%values, surfaces(i), 'synthetic')) then
            key = 'wavelength_short'
            if (dry%grid%ny > 1) spacing = max(spacing, dry%lengths(2)/dry%grid%ny)
            if (.not. dry%values%is_given(surfaces(i), key)) wave = least_nodes*spacing
         end if
         if (wave < (least_nodes - rounding)*spacing) call dry%values%refuse(surfaces(i), key, &
            'found ' // to_text(wave) // ' m, expected at least two nodes a wave, ' &
            // to_text(2.0_wp*spacing, 3) // ' m, or more intervals')
         if (wave < huge(1.0_wp)) finest = min(finest, wave/spacing)
      end do
      if (finest < min_nodes - rounding .and. dry%values%findings%count == 0) call add_sentence( &
         dry%note, 'the finest waves of the surface have ' // to_text(finest, 2) // ' nodes, of ' &
         // to_text(nint(min_nodes)) // ' that are needed for its contact area')
   end subroutine check_waves

   !> The shortest wave that the keys of a surface give [m]; huge: none.
   pure elemental function finest_wave(values, group) result(wave)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      real(wp) :: wave
      type(value_t) :: slot

      slot = values%slot(group, trim(merge('wavelength_short', 'wavelength      ', &
         has_shape(values, group, 'synthetic'))))
      wave = minval(slot%reals)
   end function finest_wave

end module dry_checks
