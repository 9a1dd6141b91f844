!> The matrix of the changes of U, V and P in the equations of the film, as a band, and its factors.
!>
!> A column of the grid has its V, its P and the U of the face to its right, one column after the
!> other. The entries are read from the changes of the rows with many unknowns at a time, so far
!> apart that no row depends on two. Changes with U outside the band are neglected: they are of
!> fourth order in delta. The change by the mean pressure of the Reynolds part is not here.
module momentum_matrix
   use linear_systems, only: band_matrix_t, new_band, solve_band
   use kinds, only: wp
   use momentum_problem, only: film_flow_t, momentum_problem_t, new_flow
   use momentum_rows, only: momentum_rows_t, momentum_terms_t, rows_change
   implicit none (type, external)
   private

   public :: fill_momentum, momentum_matrix_t, pack_rows, solve_momentum

   !> Kinds of unknowns.
   integer, parameter :: kind_u = 1, kind_v = 2, kind_p = 3
   !> Rows that depend on an unknown of each kind, by columns and layers from it, first and last:
   !> rows of x at faces, the others at nodes; rows of x and mass in layers, of z on edges.
   integer, parameter :: x_columns(2, 3) = reshape([-2, 2, -1, 2, 0, 1], [2, 3])
   integer, parameter :: node_columns(2, 3) = reshape([-2, 1, -1, 1, -1, 1], [2, 3])
   integer, parameter :: x_layers(2, 3) = reshape([-3, 3, -2, 3, -2, 2], [2, 3])
   integer, parameter :: z_layers(2, 3) = reshape([-3, 2, -2, 2, -2, 1], [2, 3])
   integer, parameter :: mass_layers(2, 3) = reshape([0, 0, 0, 1, -1, 1], [2, 3])
   !> Distances at which no row depends on two of them.
   integer, parameter :: column_period(3) = [5, 4, 3], layer_period(3) = [7, 6, 5]
   !> Beyond one column of unknowns the band reaches this far past the layers of another: as far as
   !> the rows across the film at a node depend on the velocities of the nearest three faces.
   integer, parameter :: margin = 4

   !> The band, and storage for one change.
   type :: momentum_matrix_t
      type(band_matrix_t) :: band
      type(film_flow_t), private :: change
      type(momentum_rows_t), private :: rows
   end type momentum_matrix_t

contains

   !> Fills the band, to be factored, at a flow with given terms. `reach`: diagonals on both sides,
   !> by default those of a column and its neighbour's velocities.
   subroutine fill_momentum(matrix, problem, flow, terms, reach)
      type(momentum_matrix_t), intent(inout) :: matrix
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(inout) :: terms
      integer, intent(in), optional :: reach
      integer :: column, kind, layer, wide
      real(wp) :: no_mean(0:problem%n)

      wide = column_size(problem) + problem%layers + margin
      if (present(reach)) wide = reach
      if (matrix%band%n == order_of(problem) .and. matrix%band%lower == wide) then
         matrix%band%entries = 0.0_wp
      else
         call new_band(matrix%band, order_of(problem), wide, wide)
         if (allocated(matrix%rows%x)) deallocate (matrix%rows%x, matrix%rows%z, matrix%rows%mass)
      end if
      no_mean = 0.0_wp
      call new_flow(matrix%change, problem)
      do kind = 1, 3
         do layer = 0, min(layer_period(kind), problem%layers) - 1
            do column = 0, column_period(kind) - 1
               call set_change(matrix%change, problem, kind, column, layer, 1.0_wp)
               call rows_change(problem, flow, terms, matrix%change, no_mean, matrix%rows)
               call store_entries(matrix, problem, kind, column, layer)
               call set_change(matrix%change, problem, kind, column, layer, 0.0_wp)
            end do
         end do
      end do
   end subroutine fill_momentum

   !> Solves A change = rows, held columns included; V of the walls stays as it is.
   subroutine solve_momentum(matrix, problem, rows, change)
      type(momentum_matrix_t), intent(in) :: matrix
      type(momentum_problem_t), intent(in) :: problem
      type(momentum_rows_t), intent(in) :: rows
      type(film_flow_t), intent(inout) :: change
      real(wp) :: x(order_of(problem))
      integer :: i, first

      call pack_rows(problem, rows, x)
      call solve_band(matrix%band, x)
      associate (m => problem%layers)
         do i = 0, problem%n
            first = i*column_size(problem)
            change%v(1:m - 1, i) = x(first + 1:first + m - 1)
            change%p(:, i) = x(first + m:first + 2*m - 1)
            if (i < problem%n) change%u(:, i + 1) = x(first + 2*m:first + 3*m - 1)
         end do
      end associate
   end subroutine solve_momentum

   !> Copies the rows in the order of the matrix.
   pure subroutine pack_rows(problem, rows, x)
      type(momentum_problem_t), intent(in) :: problem
      type(momentum_rows_t), intent(in) :: rows
      real(wp), intent(out) :: x(:)
      integer :: i, first

      associate (m => problem%layers)
         do i = 0, problem%n
            first = i*column_size(problem)
            x(first + 1:first + m - 1) = rows%z(:, i)
            x(first + m:first + 2*m - 1) = rows%mass(:, i)
            if (i < problem%n) x(first + 2*m:first + 3*m - 1) = rows%x(:, i + 1)
         end do
      end associate
   end subroutine pack_rows

   !> Number of unknowns of a column.
   pure integer function column_size(problem)
      type(momentum_problem_t), intent(in) :: problem

      column_size = 3*problem%layers - 1
   end function column_size

   !> Number of all unknowns: the last column has no U.
   pure integer function order_of(problem) result(order)
      type(momentum_problem_t), intent(in) :: problem

      order = (problem%n + 1)*column_size(problem) - problem%layers
   end function order_of

   !> Sets every unknown of a kind (U, V, P) in the columns and layers of one colour.
   pure subroutine set_change(change, problem, kind, column, layer, value)
      type(film_flow_t), intent(inout) :: change
      type(momentum_problem_t), intent(in) :: problem
      integer, intent(in) :: kind, column, layer
      real(wp), intent(in) :: value

      associate (m => problem%layers, n => problem%n, step => layer_period(kind), &
         stride => column_period(kind))
         select case (kind)
         case (kind_u)
            change%u(1 + layer:m:step, 1 + column:n:stride) = value
         case (kind_v)
            change%v(1 + layer:m - 1:step, column:n:stride) = value
         case default   ! kind_p
            change%p(1 + layer:m:step, column:n:stride) = value
         end select
      end associate
   end subroutine set_change

   !> Stores the entries of the unknowns of one colour from the rows.
   subroutine store_entries(matrix, problem, kind, column, layer)
      type(momentum_matrix_t), intent(inout) :: matrix
      type(momentum_problem_t), intent(in) :: problem
      integer, intent(in) :: kind, column, layer
      integer :: i, j, k, l, width, unknown

      width = column_size(problem)
      associate (m => problem%layers, n => problem%n)
         do i = column + merge(1, 0, kind == kind_u), n, column_period(kind)
            do j = 1 + layer, merge(m - 1, m, kind == kind_v), layer_period(kind)
               select case (kind)
               case (kind_u)
                  unknown = i*width - m + j
               case (kind_v)
                  unknown = i*width + j
               case default   ! kind_p
                  unknown = i*width + m - 1 + j
               end select
               do k = max(1, i + x_columns(1, kind)), min(n, i + x_columns(2, kind))
                  do l = max(1, j + x_layers(1, kind)), min(m, j + x_layers(2, kind))
                     call store(k*width - m + l, matrix%rows%x(l, k))
                  end do
               end do
               do k = max(0, i + node_columns(1, kind)), min(n, i + node_columns(2, kind))
                  do l = max(1, j + z_layers(1, kind)), min(m - 1, j + z_layers(2, kind))
                     call store(k*width + l, matrix%rows%z(l, k))
                  end do
                  do l = max(1, j + mass_layers(1, kind)), min(m, j + mass_layers(2, kind))
                     call store(k*width + m - 1 + l, matrix%rows%mass(l, k))
                  end do
               end do
            end do
         end do
      end associate

   contains

      !> Stores one entry, if it is within the band.
      subroutine store(row, value)
         integer, intent(in) :: row
         real(wp), intent(in) :: value

         associate (band => matrix%band)
            if (abs(row - unknown) <= band%lower) band%entries(band%lower + band%upper + 1 + row &
               - unknown, unknown) = value
         end associate
      end subroutine store

   end subroutine store_entries

end module momentum_matrix
