!> Reference values of dry contacts: dimensionless numbers times these are SI.
module dry_scaling
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dry_scaling_t, new_dry_scaling

   !> Lengths x L, heights x s, pressures x E' s/(4 L): then 1/q is the transfer function of the
   !> half-space.
   type :: dry_scaling_t
      !> L, length of the domain in x [m].
      real(wp) :: length
      !> s, rms of the heights; for a flat surface L [m].
      real(wp) :: height
      !> E' s/(4 L) [Pa].
      real(wp) :: pressure
      !> E' [Pa].
      real(wp) :: reduced_modulus
      !> Whether all heights are equal, except for rounding.
      logical :: is_flat = .false.

   end type dry_scaling_t

contains

   !> Reference values for the heights `z` [m] on a domain of `length` [m] and the modulus E' [Pa].
   pure function new_dry_scaling(z, length, reduced_modulus) result(scaling)
      real(wp), intent(in) :: z(:), length, reduced_modulus
      type(dry_scaling_t) :: scaling

      scaling%length = length
      scaling%height = norm2(z - sum(z)/size(z))/sqrt(real(size(z), wp))
      scaling%is_flat = scaling%height <= length*epsilon(1.0_wp)
      if (scaling%is_flat) scaling%height = length
      scaling%reduced_modulus = reduced_modulus
      scaling%pressure = reduced_modulus*scaling%height/(4.0_wp*length)
   end function new_dry_scaling

end module dry_scaling
