!> Reference values of dry contacts: the only place that converts between SI and dimensionless
!> numbers.
module dry_scaling
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: contact_modulus, dry_scaling_t, load_number, new_dry_scaling

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
   contains
      procedure :: height_in_si
      procedure :: pressure_in_si
      procedure :: energy_in_si
      procedure :: scaled_height
      procedure :: scaled_pressure
      procedure :: domain_area
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

   !> A height or gap in m.
   pure elemental real(wp) function height_in_si(self, height) result(metres)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: height

      metres = self%height*height
   end function height_in_si

   !> A pressure in Pa.
   pure elemental real(wp) function pressure_in_si(self, pressure) result(pascal)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: pressure

      pascal = self%pressure*pressure
   end function pressure_in_si

   !> Work of pressure on height, over an `area` [m^2] in J, over a length [m] in J/m.
   pure elemental real(wp) function energy_in_si(self, area, work) result(energy)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: area, work

      energy = area*self%pressure*self%height*work
   end function energy_in_si

   !> A height of this many `metres`, dimensionless.
   pure elemental real(wp) function scaled_height(self, metres) result(height)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: metres

      height = metres/self%height
   end function scaled_height

   !> A pressure of this many `pascal`, dimensionless.
   pure elemental real(wp) function scaled_pressure(self, pascal) result(pressure)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: pascal

      pressure = pascal/self%pressure
   end function scaled_pressure

   !> Area of the domain [m^2] with Ly/Lx = `aspect`, length of a line [m].
   pure real(wp) function domain_area(self, aspect, is_line) result(area)
      class(dry_scaling_t), intent(in) :: self
      real(wp), intent(in) :: aspect
      logical, intent(in) :: is_line

      area = self%length
      if (.not. is_line) area = area*self%length*aspect
   end function domain_area

   !> `pressure` [Pa] over the mean pressure w/L [Pa] of a load, above 0. For E' s/(4 L) this is E'
   !> s/(4 w), the only number of an elastic contact in (3.19) of the thesis; for the hardness it is
   !> H_s L/w.
   pure elemental real(wp) function load_number(pressure, mean_pressure) result(number)
      real(wp), intent(in) :: pressure, mean_pressure

      number = pressure/mean_pressure
   end function load_number

   !> E' against a rigid plane: 2/E' = (1 - nu^2)/E.
   pure elemental function contact_modulus(youngs_modulus, poisson_ratio) result(reduced_modulus)
      real(wp), intent(in) :: youngs_modulus, poisson_ratio
      real(wp) :: reduced_modulus

      reduced_modulus = 2.0_wp*youngs_modulus/(1.0_wp - poisson_ratio**2)
   end function contact_modulus

end module dry_scaling
