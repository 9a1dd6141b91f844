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
      !> Cell of each node, and number of nodes in each cell of the lowest level, 0 in all others.
      integer, allocatable :: cell(:), nodes(:)
      !> Place of each cell on its level: its column and, `bits` higher, its row; the cell above it.
      integer, allocatable :: place(:), parent(:)
      !> The cell at each place of one level (0 ...), 0: none; 0 between calls.
      integer, allocatable :: at(:)
   end type cell_tree_t

contains

   !> Joins nodes to cells of the lowest level, in x, in y, or both (`is_joined`), with columns of
   !> `bits` bits. `node`: the listed nodes of a grid of `nodes` (2), rising; row j begins at
   !> begin(j). Rows and columns shifted past the end of a periodic grid come first.
   pure subroutine join_nodes(tree, nodes, is_periodic, node, begin, is_joined, bits)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      integer, contiguous, intent(in) :: node(:), begin(:)
      logical, intent(in) :: is_joined(2)
      integer, intent(in) :: bits
      integer :: before, column, j, k, past, row

      past = merge(nodes(1), huge(1), is_periodic)
      do j = 1, nodes(2)
         row = j - 1 + tree%shift(2)
         if (is_periodic) row = modulo(row, nodes(2))
         if (is_joined(2)) row = row/2
         row = ishft(row, bits)
         before = (j - 1)*nodes(1) + 1 - tree%shift(1)
         do k = begin(j), begin(j + 1) - 1
            column = node(k) - before
            if (column >= past) column = column - past
            if (is_joined(1)) column = ishft(column, -1)
            tree%cell(k) = row + column
         end do
      end do
      call find_cells(1, tree%cell(:size(node)), tree%place, tree%at, tree%first(2))
      tree%nodes(:tree%first(2) - 1) = 0
      do k = 1, size(node)
         tree%nodes(tree%cell(k)) = tree%nodes(tree%cell(k)) + 1
      end do
   end subroutine join_nodes

   !> Joins the cells of `level` >= 1, whose columns have bits(1) bits, to those of the next, whose
   !> have bits(2).
   pure subroutine join_cells(tree, level, is_joined, bits)
      type(cell_tree_t), intent(inout) :: tree
      integer, intent(in) :: level
      logical, intent(in) :: is_joined(2)
      integer, intent(in) :: bits(2)
      integer :: column, k, row

      associate (begin => tree%first(level), end => tree%first(level + 1) - 1, &
         next => tree%first(level + 2))
         do k = begin, end
            column = iand(tree%place(k), maskr(bits(1)))
            row = ishft(tree%place(k), -bits(1))
            if (is_joined(1)) column = ishft(column, -1)
            if (is_joined(2)) row = ishft(row, -1)
            tree%parent(k) = ishft(row, bits(2)) + column
         end do
         call find_cells(end + 1, tree%parent(begin:end), tree%place, tree%at, next)
         tree%nodes(end + 1:next - 1) = 0
      end associate
   end subroutine join_cells

   !> Finds the `cell` at each of the places that `cell` holds, and the `place` of each; `first` is
   !> the first cell of the level, `next` the one behind the last. `at` is empty before and after.
   pure subroutine find_cells(first, cell, place, at, next)
      integer, intent(in) :: first
      integer, contiguous, intent(inout) :: cell(:), place(:), at(0:)
      integer, intent(out) :: next
      integer :: here, k

      here = first - 1
      do k = 1, size(cell)
         if (at(cell(k)) == 0) then
            here = here + 1
            at(cell(k)) = here
            place(here) = cell(k)
         end if
         cell(k) = at(cell(k))
      end do
      do k = first, here
         at(place(k)) = 0
      end do
      next = here + 1
   end subroutine find_cells

end module cell_tree
