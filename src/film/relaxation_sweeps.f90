!> Sweeps of the chosen smoother on one level, for the cycle and for plain Block-Jacobi.
module relaxation_sweeps
   use film_equation, only: evaluate_deflection, update_film
   use force_balance, only: relax_load
   use kinds, only: wp
   use line_hierarchy, only: count_work, line_hierarchy_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_hybrid, smoother_line
   use line_level, only: largest_pressure
   use reynolds_line, only: evaluate_reynolds, reynolds_diagonals
   use smoothers, only: block_jacobi_sweep, gauss_seidel_sweep, line_sweep
   implicit none (type, external)
   private

   public :: smooth, sweep_under_load

contains

   !> `coarse_sweeps` sweeps on level k with the force balance relaxed after each (thesis, section
   !> 2.7).
   subroutine sweep_under_load(hierarchy, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k
      integer :: i

      do i = 1, hierarchy%relaxation%coarse_sweeps
         call smooth(hierarchy, k, 1, is_last_leg=.true.)
         call relax_load(hierarchy%levels(k), hierarchy%relaxation%load_relaxation)
      end do
   end subroutine sweep_under_load

   !> `sweeps` of the chosen smoother on level k. The hybrid sweeps by line before and downstream
   !> after the correction.
   subroutine smooth(hierarchy, k, sweeps, is_last_leg)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, sweeps
      logical, intent(in) :: is_last_leg
      integer :: i, smoother

      smoother = hierarchy%relaxation%smoother
      if (smoother == smoother_hybrid) smoother = merge(smoother_gauss_seidel, smoother_line, &
         is_last_leg)
      do i = 1, sweeps
         call sweep(hierarchy, k, smoother)
      end do
      if (smoother == smoother_line) call update_film(hierarchy%levels(k))
      call count_work(hierarchy, k, sweeps)
   end subroutine smooth

   !> One sweep of one smoother, from coefficients evaluated at the present state.
   subroutine sweep(hierarchy, k, smoother)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, smoother
      real(wp) :: kernel_diagonal

      associate (level => hierarchy%levels(k), choice => hierarchy%relaxation)
         if (maxval(level%state%pressure) >= largest_pressure) return
         kernel_diagonal = min(level%kernel(0), -choice%kernel_bound*level%dx)
         if (choice%film_is_recomputed) then
            call update_film(level)
         else
            call evaluate_deflection(level)
         end if
         call evaluate_reynolds(level)
         call reynolds_diagonals(level, kernel_diagonal)
         select case (smoother)
         case (smoother_block_jacobi)
            call block_jacobi_sweep(level, kernel_diagonal, choice%relaxation)
         case (smoother_gauss_seidel)
            call gauss_seidel_sweep(level, kernel_diagonal, choice%relaxation)
         case (smoother_line)
            call line_sweep(level, choice%relaxation)
         case default
            error stop 'sweep: a smoother without its case'
         end select
      end associate
   end subroutine sweep

end module relaxation_sweeps
