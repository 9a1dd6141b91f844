!> A tree over a set of nodes of a grid: each node lies in a cell of 2 (line) or 2 x 2 (area) nodes,
!> each cell in one twice as large, and so on; only cells that contain nodes exist.
module cell_tree
   implicit none (type, external)
   private

   public :: cell_tree_t, join_cells, join_nodes

   !> Most doublings of a cell's side.
   integer, parameter, public :: max_levels = 31

   !> Cells of all levels are stored one level after the other, each in the order of its first node.
   type :: cell_tree_t
      !> Column and row of the grid's first node.
      integer :: shift(2) = 0
      !> First cell of each level above the nodes, and of the one above the last.
      integer :: first(max_levels + 1) = 1
      !> Cell of each node, and number of nodes in each cell of the lowest level.
      integer, allocatable :: cell(:), nodes(:)
      !> Column and row of each cell on its level; the cell above it.
      integer, allocatable :: column(:), row(:), parent(:)
      !> The cell at each place of one level, 0: none; 0 between calls.
      integer, allocatable :: place(:)
   end type cell_tree_t

contains

   !> Joins nodes to cells of the lowest level, in x, in y, or both (`is_joined`), which has
   !> `across` columns. `node`: the listed nodes of a grid of `nodes` (2), rising; row j begins at
   !> begin(j). Rows and columns shifted past the end of a periodic grid come first.
   pure subroutine join_nodes(tree, nodes, is_periodic, node, begin, is_joined, across)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      integer, contiguous, intent(in) :: node(:), begin(:)
      logical, intent(in) :: is_joined(2)
      integer, intent(in) :: across
      integer :: before, bits(2), cell, column, here, j, k, past, row

      bits = merge(-1, 0, is_joined)
      past = merge(nodes(1), huge(1), is_periodic)
      here = 0
      do j = 1, nodes(2)
         row = j - 1 + tree%shift(2)
         if (is_periodic) row = modulo(row, nodes(2))
         row = ishft(row, bits(2))
         before = (j - 1)*nodes(1) + 1 - tree%shift(1)
         do k = begin(j), begin(j + 1) - 1
            column = node(k) - before
            if (column >= past) column = column - past
            call enter(tree, ishft(column, bits(1)), row, across, here, cell)
            tree%cell(k) = cell
            tree%nodes(cell) = tree%nodes(cell) + 1
         end do
      end do
      tree%first(2) = here + 1
      call clear(tree, 1, across)
   end subroutine join_nodes

   !> Joins the cells of `level` >= 1 to those of the next, which has `across` columns.
   pure subroutine join_cells(tree, level, is_joined, across)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: level
      logical, intent(in) :: is_joined(2)
      integer, intent(in) :: across
      integer :: bits(2), cell, here, k

      bits = merge(-1, 0, is_joined)
      here = tree%first(level + 1) - 1
      do k = tree%first(level), tree%first(level + 1) - 1
         call enter(tree, ishft(tree%column(k), bits(1)), ishft(tree%row(k), bits(2)), across, &
            here, cell)
         tree%parent(k) = cell
      end do
      tree%first(level + 2) = here + 1
      call clear(tree, level + 1, across)
   end subroutine join_cells

   !> Finds the `cell` of a column and a row on a level; a new one comes behind cell `here`.
   pure subroutine enter(tree, column, row, across, here, cell)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: column, row, across
      integer, intent(inout) :: here
      integer, intent(out) :: cell
      integer :: place

      place = 1 + column + across*row
      cell = tree%place(place)
      if (cell > 0) return
      here = here + 1
      cell = here
      tree%place(place) = cell
      tree%column(cell) = column
      tree%row(cell) = row
      tree%nodes(cell) = 0
   end subroutine enter

   !> Empties the places of a `level` again.
   pure subroutine clear(tree, level, across)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: level, across
      integer :: k

      do k = tree%first(level), tree%first(level + 1) - 1
         tree%place(1 + tree%column(k) + across*tree%row(k)) = 0
      end do
   end subroutine clear

end module cell_tree
