!> What the stored fields of a lubricated line contact are: name, meaning, unit and scale, each in
!> one place.
module result_labels
   use hdf5_dataset, only: label_t, new_label
   use kinds, only: wp
   use line_state, only: line_state_t
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: field_label, field_values, quantity_label

   !> Names of the fields of `line_state_t`, as in /solution.
   character(len=*), parameter, public :: field_names(8) = [character(len=14) :: 'x', 'pressure', &
      'film_thickness', &
      'viscosity', 'density', 'slip_factor', 'roughness_1', 'roughness_2']

contains

   !> Label of a field of `field_names`.
   pure function field_label(name, scaling) result(label)
      character(*), intent(in) :: name
      type(scaling_t), intent(in) :: scaling
      type(label_t) :: label

      select case (name)
      case ('x')
         label = quantity_label('position along the contact, X = x/b', 'm', scaling%half_width, &
            scaling)
      case ('pressure')
         label = quantity_label('pressure, P = p/p_h', 'Pa', scaling%hertz_pressure, scaling)
      case ('film_thickness')
         label = quantity_label('film thickness, H = h R/b^2', 'm', scaling%film, scaling)
      case ('viscosity')
         label = quantity_label('viscosity over ambient viscosity, mu/mu_0', 'Pa s', &
            scaling%viscosity, scaling)
      case ('density')
         label = new_label('density over ambient density, rho/rho_0', '1')
      case ('slip_factor')
         label = new_label('Eyring slip factor S; 1 for a Newtonian fluid', '1')
      case ('roughness_1')
         label = quantity_label('height of surface 1, positive out of its material, psi_1 R/b^2', &
            'm', scaling%film, scaling)
      case ('roughness_2')
         label = quantity_label('height of surface 2, positive out of its material, psi_2 R/b^2', &
            'm', scaling%film, scaling)
      case default
         label = new_label(name, '1')
      end select
   end function field_label

   !> Values of a field of `field_names` (nx); none for an unknown name or a field that the state
   !> does not hold.
   pure function field_values(name, state) result(values)
      character(*), intent(in) :: name
      type(line_state_t), intent(in) :: state
      real(wp), allocatable :: values(:)

      allocate (values(0))
      select case (name)
      case ('x')
         if (allocated(state%x)) values = state%x
      case ('pressure')
         if (allocated(state%pressure)) values = state%pressure
      case ('film_thickness')
         if (allocated(state%film_thickness)) values = state%film_thickness
      case ('viscosity')
         if (allocated(state%viscosity)) values = state%viscosity
      case ('density')
         if (allocated(state%density)) values = state%density
      case ('slip_factor')
         if (allocated(state%slip_factor)) values = state%slip_factor
      case ('roughness_1')
         if (allocated(state%roughness_1)) values = state%roughness_1
      case ('roughness_2')
         if (allocated(state%roughness_2)) values = state%roughness_2
      case default
         return
      end select
   end function field_values

   !> Label of a scaled quantity: `si_scale` [si_units], or a pure number if the SI scales are
   !> unknown (input by Moes' numbers).
   pure function quantity_label(long_name, si_units, si_scale, scaling) result(label)
      character(*), intent(in) :: long_name
      character(*), intent(in) :: si_units
      real(wp), intent(in) :: si_scale
      type(scaling_t), intent(in) :: scaling
      type(label_t) :: label

      if (scaling%is_dimensional) then
         label = new_label(long_name, si_units, si_scale)
      else
         label = new_label(long_name, '1')
      end if
   end function quantity_label

end module result_labels
