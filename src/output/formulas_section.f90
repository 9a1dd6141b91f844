!> /formulas of a result and lines of the closing table: handbook films beside the computed one.
module formulas_section
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use line_contact, only: finest_wave, line_contact_t
   use line_summary, only: line_summary_t
   use lubricant, only: fluid_t, thins
   use moes, only: film_by_formula, formula_rows, formulas_hold, known_bias, moes_l_mean_from_sum, &
      moes_m_mean_from_sum
   use quantities, only: quantity_rows
   use text, only: number_text, prefixed_text
   use result_labels, only: scaled_label
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: formula_contact_t, formula_lines, formulas_of, write_formulas

   !> What the formulas, and how far they are off, depend on.
   type :: formula_contact_t
      !> Whether the contact is one for which they are meant.
      logical :: is_known = .false.
      !> Moes' numbers, mean speed [-].
      real(wp) :: m = 0.0_wp, l = 0.0_wp
      !> The oil; where it thins how far they are off is not known.
      type(fluid_t) :: fluid
   end type formula_contact_t

contains

   !> What formulas need of a steady `contact`: they hold for smooth ones in certain ranges.
   pure function formulas_of(contact) result(known)
      type(line_contact_t), intent(in) :: contact
      type(formula_contact_t) :: known

      known%m = moes_m_mean_from_sum(contact%moes_m_sum)
      known%l = moes_l_mean_from_sum(contact%moes_l_sum)
      known%is_known = .not. finest_wave(contact) < huge(1.0_wp) &
         .and. formulas_hold(known%m, known%l)
      known%fluid = contact%fluid
   end function formulas_of

   !> Writes /formulas: films, and how far above the computed one; nothing if none is meant for it.
   subroutine write_formulas(file, contact, summary, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(formula_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: path
      type(label_t) :: label
      real(wp) :: film
      integer :: i

      if (.not. contact%is_known) return
      call file%create_group('/formulas')
      call write_attribute(file, '/formulas', 'about', 'films by formulas of handbooks; '// &
         'difference: by how much a film lies above the computed quantity, relative to that; '// &
         'known_bias: the differences between which nine of ten such contacts lie')
      do i = 1, size(formula_rows)
         associate (row => formula_rows(i))
            path = '/formulas/'//trim(row%name)
            film = film_by_formula(i, contact%m, contact%l)
            label = scaled_label('', 'film', scaling)
            call write_dataset(file, path, film*label%si_scale, new_label(trim(row%text), &
               label%si_units))
            if (label%si_units == '1') call write_attribute(file, path, 'units', '1')
            call write_attribute(file, path, 'dimensionless', film)
            call write_attribute(file, path, 'quantity', trim(row%quantity))
            call write_attribute(file, path, 'difference', difference(film, row%quantity, summary))
            if (.not. thins(contact%fluid)) call write_attribute(file, path, 'known_bias', &
               known_bias(i, contact%fluid))
            call write_attribute(file, path, 'source', trim(row%source))
         end associate
      end do
   end subroutine write_formulas

   !> The lines of the closing table; empty: none.
   function formula_lines(contact, summary, scaling) result(lines)
      type(formula_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: lines, value
      real(wp) :: bias(2), film
      integer :: i

      lines = ''
      if (.not. contact%is_known) return
      do i = 1, size(formula_rows)
         associate (row => formula_rows(i))
            film = film_by_formula(i, contact%m, contact%l)
            value = number_text(film, 4)
            if (scaling%is_dimensional) value = prefixed_text(film*scaling%film, 'm')
            if (i > 1) lines = lines//new_line('a')
            lines = lines//merge('  formulas  ', '            ', i == 1)//trim(row%quantity)//' ' &
               //value//', '//percent(difference(film, row%quantity, summary))//' %: ' &
               //trim(row%authors)
            bias = known_bias(i, contact%fluid)
            if (thins(contact%fluid)) then
               lines = lines//', of oil that does not thin'
            else
               lines = lines//', known bias '//percent(bias(1))//' to '//percent(bias(2))//' %'
            end if
         end associate
      end do
   end function formula_lines

   !> By how much `film` lies above a computed quantity, relative to that.
   pure real(wp) function difference(film, quantity, summary) result(share)
      real(wp), intent(in) :: film
      character(*), intent(in) :: quantity
      type(line_summary_t), intent(in) :: summary

      share = film/summary%of(findloc(quantity_rows%name == quantity, .true., 1))%value - 1
   end function difference

   !> A share in per cent with its sign, to one of them.
   pure function percent(share)
      real(wp), intent(in) :: share
      character(:), allocatable :: percent

      percent = number_text(real(nint(100*share), wp), 3)
      if (nint(100*share) > 0) percent = '+'//percent
   end function percent

end module formulas_section
