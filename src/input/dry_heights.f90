!> The heights of a dry case on its first grid, and the same surface on finer ones.
module dry_heights
   use dry_case, only: dry_case_t
   use dry_checks, only: has_shape
   use dry_surfaces, only: add_surface
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: is_refinable, make_heights, refine_heights

contains

   !> Fills the heights on the grid of `dry`. Findings: no memory; what `add_surface` finds.
   subroutine make_heights(dry, findings)
      type(dry_case_t), intent(inout) :: dry
      type(findings_t), intent(inout) :: findings
      integer :: status

      associate (values => dry%recipe%values, folder => dry%recipe%folder, &
         radius => dry%recipe%radius)
         allocate (dry%height(dry%grid%nx*dry%grid%ny), source=0.0_wp, stat=status)
         if (status /= 0) then
            call findings%add(values%line_of('domain', ''), 'domain', '', &
               'found no memory for the heights of the grid')
            return
         end if
         call add_surface(values, 'surface_1', folder, radius, dry, findings)
         call add_surface(values, 'surface_2', folder, radius, dry, findings)
      end associate
   end subroutine make_heights

   !> The surface on `nodes` in x and y: formulas at the new nodes, synthetic and periodic heights
   !> by their Fourier series. Errors (input_error): as the findings of `make_heights`.
   subroutine refine_heights(dry, nodes, error)
      type(dry_case_t), intent(inout) :: dry
      integer, intent(in) :: nodes(2)
      type(error_t), allocatable, intent(out) :: error
      type(findings_t) :: found

      dry%grid%nx = nodes(1)
      dry%grid%ny = nodes(2)
      deallocate (dry%height)
      call make_heights(dry, found)
      if (found%count > 0) call fail(error, input_error, found%report('finer grid'))
   end subroutine refine_heights

   !> False where the heights are known at the nodes of a file only: without a period they have no
   !> Fourier series.
   pure function is_refinable(dry)
      type(dry_case_t), intent(in) :: dry
      logical :: is_refinable

      is_refinable = dry%is_periodic .or. .not. (has_shape(dry%recipe%values, 'surface_1', &
         'file') .or. &
                                                 has_shape(dry%recipe%values, 'surface_2', 'file'))
   end function is_refinable

end module dry_heights
