!> A tree over a set of nodes of a grid: each node lies in a cell of 2 (line) or 2 x 2 (area) nodes,
!> each cell in one twice as large, and so on; only cells that contain nodes exist.
module cell_tree
   implicit none (type, external)
   private

   public :: cell_tree_t, join_cells, place_nodes

   !> Most doublings of a cell's side.
   integer, parameter, public :: max_levels = 31

   !> Cells of all levels are stored one level after the other, the nodes first, each level by rows.
   type :: cell_tree_t
      !> Position of the grid's first node in the first row of smallest cells, and its row.
      integer :: shift(2) = 0
      !> First cell of each level, and of the one above the last.
      integer :: first(0:max_levels + 1) = 1
      !> First cell of each row of the last level.
      integer, allocatable :: row(:)
      !> Position of each node in the list of nodes.
      integer, allocatable :: place(:)
      !> Column of each cell on its level; the cell above it, counted from the first one above the
      !> nodes.
      integer, allocatable :: column(:), parent(:)
   end type cell_tree_t

contains

   !> Puts the nodes in the order of the tree: with the shift, rows and columns that it moves past
   !> the end of a periodic grid come first.
   pure subroutine place_nodes(tree, nodes, is_periodic, node, rows)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      integer, contiguous, intent(in) :: node(:)
      integer, intent(out) :: rows
      integer :: first(0:nodes(2)), begin, j, k, n, row

      k = 1
      do j = 0, nodes(2) - 1
         first(j) = k
         row_end: do while (k <= size(node))
            if (node(k) > (j + 1)*nodes(1)) exit row_end
            k = k + 1
         end do row_end
      end do
      first(nodes(2)) = k
      rows = nodes(2)
      if (.not. is_periodic) rows = rows + tree%shift(2)
      if (.not. allocated(tree%row)) allocate (tree%row(0:rows))
      n = 0
      do row = 0, rows - 1
         tree%row(row) = n + 1
         j = row - tree%shift(2)
         if (is_periodic) j = modulo(j, nodes(2))
         if (j < 0) cycle
         begin = first(j + 1)
         if (is_periodic) begin = first(j) + count(node(first(j):first(j + 1) - 1) <= (j &
            + 1)*nodes(1) - tree%shift(1))
         call place_run(tree, node, begin, first(j + 1) - 1, &
            j*nodes(1) + nodes(1) - tree%shift(1), n)
         call place_run(tree, node, first(j), begin - 1, j*nodes(1) - tree%shift(1), n)
      end do
      tree%row(rows) = n + 1
      tree%first(0:1) = [1, n + 1]
   end subroutine place_nodes

   !> Appends the nodes `begin` ... `end` of the list behind the `n` nodes placed before; columns
   !> count from `before` + 1.
   pure subroutine place_run(tree, node, begin, end, before, n)
      type(cell_tree_t), intent(inout) :: tree
      integer, contiguous, intent(in) :: node(:)
      integer, intent(in) :: begin, end, before
      integer, intent(inout) :: n
      integer :: k

      do k = begin, end
         n = n + 1
         tree%place(n) = k
         tree%column(n) = node(k) - before - 1
      end do
   end subroutine place_run

   !> Joins the cells of `level` to those of the next, in x, in y, or both (`is_joined`).
   pure subroutine join_cells(tree, level, rows, is_joined)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: level
      integer, intent(inout) :: rows
      logical, intent(in) :: is_joined(2)
      integer :: ends(2), here, next(2), row, rows_above, shift

      shift = merge(-1, 0, is_joined(1))
      rows_above = merge((rows + 1)/2, rows, is_joined(2))
      here = tree%first(level + 1) - 1
      do row = 0, rows_above - 1
         next(1) = tree%row(merge(2*row, row, is_joined(2)))
         ends(1) = tree%row(merge(2*row + 1, row + 1, is_joined(2)))
         next(2) = ends(1)
         ends(2) = ends(1)
         if (is_joined(2)) ends(2) = tree%row(min(2*row + 2, rows))
         tree%row(row) = here + 1
         call join_rows(tree%column, tree%parent, tree%first(1) - 1, next, ends, shift, here)
      end do
      tree%row(rows_above) = here + 1
      tree%first(level + 2) = here + 1
      rows = rows_above
   end subroutine join_cells

   !> Joins the cells of one row or of two: `next` ... `ends` - 1 of the columns `cell`, the first
   !> `nodes` of which are nodes; columns are shifted by `shift` bits.
   pure subroutine join_rows(cell, parent, nodes, next, ends, shift, here)
      integer, contiguous, intent(inout) :: cell(:), parent(:)
      integer, intent(in) :: nodes, ends(2), shift
      integer, intent(inout) :: next(2), here
      integer :: above, column, k

      do while (next(1) < ends(1) .and. next(2) < ends(2))
         here = here + 1
         above = min(ishft(cell(next(1)), shift), ishft(cell(next(2)), shift))
         cell(here) = above
         do k = 1, 2
            same: do while (next(k) < ends(k))
               if (ishft(cell(next(k)), shift) > above) exit same
               parent(next(k)) = here - nodes
               next(k) = next(k) + 1
            end do same
         end do
      end do
      ! Remaining cells of one row.
      above = -1
      do k = minval(merge(next, huge(1), next < ends)), maxval(merge(ends, 0, next < ends)) - 1
         column = ishft(cell(k), shift)
         here = here + merge(0, 1, column == above)
         cell(here) = column
         parent(k) = here - nodes
         above = column
      end do
   end subroutine join_rows

end module cell_tree
