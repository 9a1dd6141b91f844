!> An approximate inverse of the elastic half-space on any set of nodes: a network of resistors that
!> is a tree.
!>
!> Pressure and deflection of a half-space are current into and potential of its surface (transfer
!> function 1/q). A tree replaces its inside: a resistor joins each node to a cell of 2 (line) or 2
!> x 2 (area) nodes, each cell to one twice as large, and so on. A current into one node then raises
!> the potential of another by the resistance that their paths to the root share, which depends on
!> their distance alone, about as in the half-space; the resistances are chosen so. If potentials
!> are given at some nodes and the others are left open, one sweep to the root and one back give the
!> currents of a tree exactly, in work proportional to the number of given nodes.
!>
!> This inverts the tree's matrix T restricted to the set F of given nodes; if c <= x.K x/x.T x <= C
!> for all x, this also holds for all x that are zero off F: the bound C/c on the condition number
!> does not depend on F. That of |q|, the inverse of K on all nodes, does: restricted to F it treats
!> the nodes off F as loaded too, and its condition number grows with the number of contacts.
!>
!> A tree separates neighbours that lie on two sides of a large cell. The mean of two trees, one
!> shifted by a third of the grid, does not: condition numbers of 2 to 5. Module cell_tree finds the
!> cells.
module tree_network
   use cell_tree, only: cell_tree_t, join_cells, join_nodes, max_levels
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: tree_network_t, new_tree_network

   integer, parameter :: trees = 2

   !> One tree with its resistors.
   type, extends(cell_tree_t) :: tree_t
      !> Seen from beyond the resistor above each cell, over those of a node: conductance, and
      !> current at zero potential (2, cells).
      real(wp), allocatable :: seen(:, :), potential(:)
   end type tree_t

   !> The trees over a grid.
   type :: tree_network_t
      !> Number of threads: each tree has one.
      integer :: threads = 1
      !> Nodes in x and y (1: a line).
      integer, private :: nodes(2) = 0
      logical, private :: is_periodic = .false.
      !> Levels above the nodes.
      integer, private :: levels = 0
      !> Resistor above the cells of each level, and whether they are joined in x and in y.
      real(wp), private :: resistance(0:max_levels) = 0.0_wp
      logical, private :: is_joined(2, 0:max_levels) = .false.
      !> Most cells of each level, bits of their columns, and places of the lowest level.
      integer, private :: most(0:max_levels) = 0, bits(0:max_levels) = 0, places = 0
      type(tree_t), private :: tree(trees)
   contains
      procedure :: settle, solve, spread
   end type tree_network_t

contains

   !> Prepares the trees of a grid of `nodes` (nx, ny >= 1; ny = 1: a line) with `spacing` (2),
   !> whose first and last nodes are neighbours if it `is_periodic`.
   pure subroutine new_tree_network(self, nodes, spacing, is_periodic)
      type(tree_network_t), intent(out) :: self
      integer, intent(in) :: nodes(2)
      real(wp), intent(in) :: spacing(2)
      logical, intent(in) :: is_periodic
      !> Response of a tree to a current into one half of a cell and out of the other, over that to
      !> a wave as long as the cell.
      real(wp), parameter :: halves = 2.0_wp*log(2.0_wp)
      real(wp) :: answer, answer_below, side(2)
      logical :: joined(2)
      integer :: cells(2), level, tree

      self%nodes = nodes
      self%is_periodic = is_periodic
      do tree = 1, trees
         self%tree(tree)%shift = (tree - 1)*(nodes/3)
      end do
      cells = nodes
      if (.not. is_periodic) cells = nodes + self%tree(trees)%shift
      side = spacing
      answer_below = 0.0_wp
      do level = 0, max_levels
         self%levels = level
         self%bits(level) = bit_size(1) - leadz(cells(1) - 1)
         if (level == 1) self%places = ishft(cells(2), self%bits(1))
         self%most(level) = int(min(real(cells(1), wp)*cells(2), real(huge(1), wp)))
         joined = cells > 1
         if (.not. any(joined)) exit
         ! Longer sides wait until the others have caught up.
         joined = joined .and. side < 1.5_wp*minval(side, mask=joined)
         self%is_joined(:, level) = joined
         answer = merge(1.0_wp, halves, level == 0)/pi*product(side, &
            mask=joined)**(1.0_wp/count(joined))
         self%resistance(level) = (answer - answer_below)*product(spacing/side)
         answer_below = answer
         where (joined)
            cells = (cells + 1)/2
            side = 2.0_wp*side
         end where
      end do
   end subroutine new_tree_network

   !> Builds the trees over the listed nodes `node` (rising), of which row j begins at begin(j).
   subroutine settle(self, node, begin)
      class(tree_network_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:), begin(:)
      integer :: level, tree

      if (self%levels == 0) return
      !$omp parallel do num_threads(min(self%threads, trees)) private(level) schedule(static)
      do tree = 1, trees
         associate (t => self%tree(tree))
            call make_room(t, size(node), self%places, &
               sum(min(real(self%most(1:self%levels), wp), real(size(node), wp))))
            call join_nodes(t%cell_tree_t, self%nodes, self%is_periodic, node, begin, &
               self%is_joined(:, 0), self%bits(1))
            do level = 1, self%levels - 1
               call join_cells(t%cell_tree_t, level, self%is_joined(:, level), &
                  self%bits(level:level + 1))
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine settle

   !> Allocates memory for `n` nodes, `places` of a level and `cells`.
   pure subroutine make_room(tree, n, places, cells)
      type(tree_t), intent(inout) :: tree
      integer, intent(in) :: n, places
      real(wp), intent(in) :: cells
      integer :: room

      if (allocated(tree%cell)) then
         if (size(tree%cell) >= n .and. size(tree%parent) >= cells) return
         deallocate (tree%cell, tree%nodes, tree%place, tree%parent, tree%seen, &
            tree%potential)
      else
         allocate (tree%at(0:places - 1), source=0)
      end if
      ! A growing set does not reallocate each time.
      room = int(min(1.2_wp*cells, real(huge(1), wp)))
      allocate (tree%cell(n + n/5), tree%nodes(room), tree%place(room), &
         tree%parent(room), tree%seen(2, room), tree%potential(room))
   end subroutine make_room

   !> Computes the currents into the nodes of the last `settle`, in its order, that give them the
   !> potentials `given` up to a constant; the mean of the trees. They add up to zero.
   subroutine solve(self, given, current)
      class(tree_network_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: given(:)
      real(wp), contiguous, intent(out) :: current(:)
      integer :: tree

      if (size(given) == 0 .or. self%levels == 0) then
         current = 0.0_wp
         return
      end if
      !$omp parallel do num_threads(min(self%threads, trees)) schedule(static)
      do tree = 1, trees
         associate (t => self%tree(tree))
            call begin_sums(t%nodes(:t%first(self%levels)), t%seen)
            call leave_nodes(given, t%cell, t%seen)
            call find_potentials(t, self%levels, self%resistance/self%resistance(0))
         end associate
      end do
      !$omp end parallel do
      call reach_nodes(self, current)
      current = current + given/self%resistance(0)
   end subroutine solve

   !> Computes the currents into the nodes at potential zero if those into the nodes numbered
   !> `loose` in the list are `given` and their potentials free, where `current` is zero. They add
   !> up to zero with those given, unless all are.
   subroutine spread(self, loose, given, current)
      class(tree_network_t), intent(inout) :: self
      integer, contiguous, intent(in) :: loose(:)
      real(wp), contiguous, intent(in) :: given(:)
      real(wp), contiguous, intent(out) :: current(:)
      integer :: k, tree

      if (self%levels == 0) then
         current = 0.0_wp
         return
      end if
      !$omp parallel do num_threads(min(self%threads, trees)) private(k) schedule(static)
      do tree = 1, trees
         associate (t => self%tree(tree))
            call begin_sums(t%nodes(:t%first(self%levels)), t%seen)
            do k = 1, size(loose)
               associate (cell => t%cell(loose(k)))
                  t%seen(1, cell) = t%seen(1, cell) - 1.0_wp
                  t%seen(2, cell) = t%seen(2, cell) + given(k)*self%resistance(0)
               end associate
            end do
            call find_potentials(t, self%levels, self%resistance/self%resistance(0))
         end associate
      end do
      !$omp end parallel do
      call reach_nodes(self, current)
      current(loose) = 0.0_wp
   end subroutine spread

   !> Sets the conductances from cells to their `nodes`, 0 above the lowest level, and no current.
   pure subroutine begin_sums(nodes, seen)
      integer, contiguous, intent(in) :: nodes(:)
      real(wp), contiguous, intent(inout) :: seen(:, :)
      integer :: k

      do k = 1, size(nodes)
         seen(1, k) = nodes(k)
         seen(2, k) = 0.0_wp
      end do
   end subroutine begin_sums

   !> Computes the potentials of the cells from what is seen from the lowest level.
   pure subroutine find_potentials(tree, levels, resistance)
      type(tree_t), intent(inout) :: tree
      integer, intent(in) :: levels
      real(wp), intent(in) :: resistance(0:)
      integer :: level

      do level = 1, levels - 1
         call lift(tree%first(level), tree%first(level + 1) - 1, resistance(level), tree%parent, &
            tree%seen)
      end do
      ! No current goes into the root, which has no resistor.
      associate (root => tree%first(levels))
         tree%potential(root) = 0.0_wp
         if (tree%seen(1, root) > 0.0_wp) tree%potential(root) = tree%seen(2, root) &
            /tree%seen(1, root)
      end associate
      do level = levels - 1, 1, -1
         call lower(tree%first(level), tree%first(level + 1) - 1, resistance(level), tree%parent, &
            tree%seen, tree%potential)
      end do
   end subroutine find_potentials

   !> Passes from the nodes through their resistors to the cells.
   pure subroutine leave_nodes(given, cell, seen)
      real(wp), contiguous, intent(in) :: given(:)
      integer, contiguous, intent(in) :: cell(:)
      real(wp), contiguous, intent(inout) :: seen(:, :)
      integer :: k

      do k = 1, size(given)
         seen(2, cell(k)) = seen(2, cell(k)) + given(k)
      end do
   end subroutine leave_nodes

   !> Passes from the cells `begin` ... `end` of a level through their resistors to those above.
   pure subroutine lift(begin, end, resistance, parent, seen)
      integer, intent(in) :: begin, end
      real(wp), intent(in) :: resistance
      integer, contiguous, intent(in) :: parent(:)
      real(wp), contiguous, intent(inout) :: seen(:, :)
      real(wp) :: factor
      integer :: k

      do k = begin, end
         factor = 1.0_wp/(1.0_wp + resistance*seen(1, k))
         seen(1, k) = factor*seen(1, k)
         seen(2, k) = factor*seen(2, k)
         seen(1, parent(k)) = seen(1, parent(k)) + seen(1, k)
         seen(2, parent(k)) = seen(2, parent(k)) + seen(2, k)
      end do
   end subroutine lift

   !> Computes the potentials of the cells `begin` ... `end` from those above.
   pure subroutine lower(begin, end, resistance, parent, seen, potential)
      integer, intent(in) :: begin, end
      real(wp), intent(in) :: resistance
      integer, contiguous, intent(in) :: parent(:)
      real(wp), contiguous, intent(in) :: seen(:, :)
      real(wp), contiguous, intent(inout) :: potential(:)
      integer :: k

      do k = begin, end
         potential(k) = potential(parent(k)) + resistance*(seen(2, k) - seen(1, k) &
            *potential(parent(k)))
      end do
   end subroutine lower

   !> Computes the currents into nodes at potential zero, the mean of the trees, from the potentials
   !> above them.
   subroutine reach_nodes(self, current)
      type(tree_network_t), intent(in) :: self
      real(wp), contiguous, intent(out) :: current(:)
      integer :: k

      associate (one => self%tree(1), two => self%tree(2), &
         conductance => 1.0_wp/(trees*self%resistance(0)))
         !$omp parallel do num_threads(self%threads) schedule(static)
         do k = 1, size(current)
            current(k) = -conductance*(one%potential(one%cell(k)) + two%potential(two%cell(k)))
         end do
         !$omp end parallel do
      end associate
   end subroutine reach_nodes

end module tree_network
