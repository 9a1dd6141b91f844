!> Exact Jacobian of the discrete Reynolds-Eyring operator L_R(P, H) of `reynolds_line`: bands in P and in H.
!>
!> With the film equation H = ... + H0 - K P it gives the elastic Jacobian J = JP - JH K of the Newton methods.
module reynolds_jacobian
   use face_mobility, only: face_slopes_t, fluid_face_slopes
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use mobility, only: fluid_mobility_slopes, mobility_slopes_t
   use reynolds_line, only: wedge_weights
   implicit none (type, external)
   private

   public :: reynolds_jacobian_t, new_jacobian, evaluate_jacobian

   !> Bands by offset and row: by_pressure(o, i) = dL_R(i)/dP(i+o), by_film(o, i) = dL_R(i)/dH(i+o).
   type :: reynolds_jacobian_t
      !> (-2:2, 0:n)
      real(wp), allocatable :: by_pressure(:, :)
      !> (-2:1, 0:n)
      real(wp), allocatable :: by_film(:, :)
      !> Diagonal of the elastic Jacobian JP - JH K (0:n), negative in a sound state.
      real(wp), allocatable :: diagonal(:)
      type(mobility_slopes_t) :: slopes
      !> Mobility of the faces in the sharp scheme; allocated when first used.
      type(face_slopes_t) :: faces
   end type reynolds_jacobian_t

contains

   !> Allocates the bands for `n` intervals.
   pure subroutine new_jacobian(jacobian, n)
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      integer, intent(in) :: n

      if (allocated(jacobian%diagonal)) then
         if (size(jacobian%diagonal) == n + 1) return
         deallocate (jacobian%by_pressure, jacobian%by_film, jacobian%diagonal)
         deallocate (jacobian%slopes%e, jacobian%slopes%e_p, jacobian%slopes%e_h, jacobian%slopes%e_slope)
         deallocate (jacobian%slopes%rho, jacobian%slopes%rho_p)
         jacobian%faces = face_slopes_t()
      end if
      allocate (jacobian%by_pressure(-2:2, 0:n), jacobian%by_film(-2:1, 0:n), jacobian%diagonal(0:n), source=0.0_wp)
      allocate (jacobian%slopes%e(0:n), jacobian%slopes%e_p(0:n), jacobian%slopes%e_h(0:n), jacobian%slopes%e_slope(0:n))
      allocate (jacobian%slopes%rho(0:n), jacobian%slopes%rho_p(0:n))
   end subroutine new_jacobian

   !> The bands at the present pressure and film of the level; rows 0 and n stay zero.
   pure subroutine evaluate_jacobian(contact, level, jacobian)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      integer :: i, n

      n = level%n
      jacobian%by_pressure(:, 1:n - 1) = 0.0_wp
      jacobian%by_film(:, 1:n - 1) = 0.0_wp
      if (level%is_sharp) then
         if (.not. allocated(jacobian%faces%e)) call new_faces(jacobian%faces, n)
         call fluid_face_slopes(contact%fluid, level%dx, level%pressure, level%film, jacobian%faces, jacobian%slopes%rho, &
            jacobian%slopes%rho_p)
         do i = 1, n
            call add_sharp_face(level, i, jacobian)
         end do
      else
         call fluid_mobility_slopes(contact%fluid, level%dx, level%pressure, level%film, jacobian%slopes)
         do i = 1, n
            call add_diffusion_face(level, i, jacobian)
         end do
      end if
      do i = 1, n - 1
         call add_wedge_and_squeeze(contact%lambda, level, i, jacobian)
      end do
      do concurrent (i=1:n - 1)
         jacobian%diagonal(i) = jacobian%by_pressure(0, i) &
            - jacobian%by_film(-2, i)*level%kernel(2) - jacobian%by_film(-1, i)*level%kernel(1) &
            - jacobian%by_film(0, i)*level%kernel(0) - jacobian%by_film(1, i)*level%kernel(1)
      end do
   end subroutine evaluate_jacobian

   !> Flux e(i-1/2) (P(i) - P(i-1))/dX through the face left of node i: +1/dX to row i-1, -1/dX to row i.
   pure subroutine add_diffusion_face(level, i, jacobian)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: slope, e_face, left, right, flux_p(-2:1), flux_h(-1:0)

      associate (s => jacobian%slopes, dx => level%dx, p => level%pressure)
         slope = (p(i) - p(i - 1))/dx
         e_face = 0.5_wp*(s%e(i - 1) + s%e(i))/dx
         left = 0.25_wp*s%e_slope(i - 1)*slope/dx
         right = 0.25_wp*s%e_slope(i)*slope/dx
         flux_p(-2) = -left
         flux_p(-1) = 0.5_wp*s%e_p(i - 1)*slope - e_face - right
         flux_p(0) = 0.5_wp*s%e_p(i)*slope + e_face + left
         flux_p(1) = right
         flux_h(-1) = 0.5_wp*s%e_h(i - 1)*slope
         flux_h(0) = 0.5_wp*s%e_h(i)*slope
         flux_p = flux_p/dx
         flux_h = flux_h/dx
         if (i > 1) then
            jacobian%by_pressure(-1:2, i - 1) = jacobian%by_pressure(-1:2, i - 1) + flux_p
            jacobian%by_film(0:1, i - 1) = jacobian%by_film(0:1, i - 1) + flux_h
         end if
         if (i < level%n) then
            jacobian%by_pressure(-2:1, i) = jacobian%by_pressure(-2:1, i) - flux_p
            jacobian%by_film(-1:0, i) = jacobian%by_film(-1:0, i) - flux_h
         end if
      end associate
   end subroutine add_diffusion_face

   !> The same flux with the mobility of the sharp scheme, which depends on the two nodes of the face only.
   pure subroutine add_sharp_face(level, i, jacobian)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: slope, conductance, flux_p(-1:0), flux_h(-1:0)

      associate (faces => jacobian%faces, dx => level%dx)
         slope = (level%pressure(i) - level%pressure(i - 1))/dx**2
         conductance = faces%e(i)/dx**2
         flux_p = [faces%by_p_left(i)*slope - conductance, faces%by_p_right(i)*slope + conductance]
         flux_h = [faces%by_h_left(i)*slope, faces%by_h_right(i)*slope]
         if (i > 1) then
            jacobian%by_pressure(0:1, i - 1) = jacobian%by_pressure(0:1, i - 1) + flux_p
            jacobian%by_film(0:1, i - 1) = jacobian%by_film(0:1, i - 1) + flux_h
         end if
         if (i < level%n) then
            jacobian%by_pressure(-1:0, i) = jacobian%by_pressure(-1:0, i) - flux_p
            jacobian%by_film(-1:0, i) = jacobian%by_film(-1:0, i) - flux_h
         end if
      end associate
   end subroutine add_sharp_face

   !> The wedge and the squeeze term of row i.
   pure subroutine add_wedge_and_squeeze(lambda, level, i, jacobian)
      real(wp), intent(in) :: lambda
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: weight(-2:1)
      integer :: first

      first = merge(-2, -1, i > 1)
      weight = wedge_weights(level%is_sharp, i)*lambda/level%dx
      weight(0) = weight(0) + lambda*level%inverse_time_step
      associate (s => jacobian%slopes)
         jacobian%by_pressure(first:1, i) = jacobian%by_pressure(first:1, i) &
            - weight(first:1)*s%rho_p(i + first:i + 1)*level%film(i + first:i + 1)
         jacobian%by_film(first:1, i) = jacobian%by_film(first:1, i) - weight(first:1)*s%rho(i + first:i + 1)
      end associate
   end subroutine add_wedge_and_squeeze

   !> Storage for n faces.
   pure subroutine new_faces(faces, n)
      type(face_slopes_t), intent(out) :: faces
      integer, intent(in) :: n

      allocate (faces%e(n), faces%by_p_left(n), faces%by_p_right(n), faces%by_h_left(n), faces%by_h_right(n))
   end subroutine new_faces

end module reynolds_jacobian
