!> Checks whether the contact of an open half-space stays inside the domain. Nothing presses
!> outside: a contact that reaches the border is that of a punch with sharp edges, whose pressure
!> grows there without bound.
module domain_border
   use analytic_heights, only: node_positions
   use dry_problem, only: dry_grid_t, kernel_open
   use dry_scaling, only: dry_scaling_t
   use hertz, only: line_half_width, point_radius
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: border_reason, recommended_room

   !> Length of a domain over the width of its contact that leaves room for the gap.
   real(wp), parameter :: recommended_room = 1.2_wp
   !> A parabola that explains a smaller share of the variance of the heights says nothing about the
   !> surface outside the domain.
   real(wp), parameter :: least_share = 0.5_wp

contains

   !> Why the contact pressure (nx*ny) of an open domain is no solution: it is positive at the
   !> border. Empty: it is not, or the domain is periodic. `z` (nx*ny) [m] are the heights, `load`
   !> is in N, for a line in N/m.
   pure function border_reason(grid, scaling, z, pressure, load) result(reason)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: z(:), pressure(:), load
      character(:), allocatable :: reason
      real(wp) :: half_width, radius
      logical :: is_pressed

      reason = ''
      if (grid%kernel /= kernel_open) return
      associate (nx => grid%nx, last_row => grid%nx*(grid%ny - 1))
         is_pressed = any(pressure(1::nx) > 0.0_wp) .or. any(pressure(nx::nx) > 0.0_wp)
         if (grid%ny > 1) is_pressed = is_pressed .or. any(pressure(:nx) > 0.0_wp) &
            .or. any(pressure(last_row + 1:) > 0.0_wp)
      end associate
      if (.not. is_pressed) return
      radius = fitted_radius(grid, scaling%length, z)
      if (radius <= 0.0_wp) then
         reason = 'the contact reaches the border of the open domain, towards which the '// &
            'surface does not fall: no length is enough'
         return
      end if
      if (grid%ny == 1) then
         half_width = line_half_width(load, radius, scaling%reduced_modulus)
      else
         half_width = point_radius(load, radius, scaling%reduced_modulus)
      end if
      reason = 'the contact reaches the border of the open domain, which should be about ' &
               // to_text(2.0_wp*recommended_room*half_width, 2) // ' m long for this load'
   end function border_reason

   !> Radius R [m] of the parabola c - r^2/(2 R) that fits the heights best by least squares; 0 if
   !> they do not fall towards the border, or are hardly a parabola.
   pure real(wp) function fitted_radius(grid, length, z) result(radius)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: length, z(:)
      real(wp) :: covariance, spread_of_squares, squares(size(z)), variance, x(grid%nx), y(grid%ny)
      integer :: i, j

      x = node_positions(grid%nx, length, .false.)
      y = node_positions(grid%ny, length*grid%aspect, .false.)
      squares = [((x(i)**2 + y(j)**2, i=1, grid%nx), j=1, grid%ny)]
      squares = squares - sum(squares)/size(z)
      covariance = sum(squares*z)
      variance = sum((z - sum(z)/size(z))**2)
      spread_of_squares = sum(squares**2)
      radius = 0.0_wp
      if (covariance < 0.0_wp .and. covariance**2 > least_share*variance*spread_of_squares) then
         radius = -0.5_wp*spread_of_squares/covariance
      end if
   end function fitted_radius

end module domain_border
