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
   use cell_tree, only: cell_tree_t, join_cells, max_levels, place_nodes
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: tree_network_t, new_tree_network

   integer, parameter :: trees = 2

   !> One tree with its resistors.
   type, extends(cell_tree_t) :: tree_t
      !> Seen from beyond the resistor above each cell except the nodes: conductance, and current at
      !> zero potential (2, cells).
      real(wp), allocatable :: seen(:, :)
      real(wp), allocatable :: potential(:)
      !> Currents into the nodes, in the order of the tree.
      real(wp), allocatable :: current(:)
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
      !> Most cells of each level.
      integer, private :: most(0:max_levels) = 0
      type(tree_t), private :: tree(trees)
   contains
      procedure :: settle, solve
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

   !> Builds the trees over the listed nodes `node` (rising).
   subroutine settle(self, node)
      class(tree_network_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      integer :: level, rows, tree

      !$omp parallel do num_threads(min(self%threads, trees)) private(level, rows) schedule(static)
      do tree = 1, trees
         associate (t => self%tree(tree))
            call make_room(t, size(node), &
               sum(min(real(self%most(:self%levels), wp), real(size(node), wp))))
            call place_nodes(t%cell_tree_t, self%nodes, self%is_periodic, node, rows)
            do level = 0, self%levels - 1
               call join_cells(t%cell_tree_t, level, rows, self%is_joined(:, level))
            end do
         end associate
      end do
      !$omp end parallel do
   end subroutine settle

   !> Allocates memory for `n` nodes and `cells` cells.
   pure subroutine make_room(tree, n, cells)
      type(tree_t), intent(inout) :: tree
      integer, intent(in) :: n
      real(wp), intent(in) :: cells
      integer :: room

      if (allocated(tree%place)) then
         if (size(tree%place) >= n .and. size(tree%parent) >= cells) return
         deallocate (tree%place, tree%column, tree%parent, tree%seen, tree%potential, tree%current)
      end if
      ! A growing set does not reallocate each time.
      room = int(min(1.2_wp*cells, real(huge(1), wp)))
      allocate (tree%place(n + n/5), tree%column(room), tree%parent(room))
      room = int(min(1.2_wp*(cells - n), real(huge(1), wp)))
      allocate (tree%seen(2, room), tree%potential(room), tree%current(n + n/5))
   end subroutine make_room

   !> Computes the currents into the nodes of the last `settle`, in its order, that give them the
   !> potentials `given` up to a constant, or are `given` themselves where `is_given`; the mean of
   !> the trees. They add up to zero unless all are given.
   subroutine solve(self, given, current, is_given)
      class(tree_network_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: given(:)
      real(wp), contiguous, intent(out) :: current(:)
      logical, contiguous, intent(in), optional :: is_given(:)
      integer :: tree

      if (size(given) == 0 .or. self%levels == 0) then
         current = 0.0_wp
         return
      end if
      !$omp parallel do num_threads(min(self%threads, trees)) schedule(static)
      do tree = 1, trees
         call solve_tree(self%tree(tree), self%levels, self%resistance, given, is_given)
      end do
      !$omp end parallel do
      ! The first tree is not shifted: its nodes are in the order of the list.
      call add_trees(self%tree(1)%current, self%tree(2)%current, self%tree(2)%place, current)
   end subroutine solve

   !> Computes current = first + second, the latter at its `place`.
   pure subroutine add_trees(first, second, place, current)
      real(wp), contiguous, intent(in) :: first(:), second(:)
      integer, contiguous, intent(in) :: place(:)
      real(wp), contiguous, intent(out) :: current(:)
      integer :: k

      do k = 1, size(current)
         current(place(k)) = first(place(k)) + second(k)
      end do
   end subroutine add_trees

   !> Computes the currents of one tree in `solve`: `tree%current`.
   pure subroutine solve_tree(tree, levels, resistance, given, is_given)
      type(tree_t), intent(inout) :: tree
      integer, intent(in) :: levels
      real(wp), intent(in) :: resistance(0:)
      real(wp), contiguous, intent(in) :: given(:)
      logical, contiguous, intent(in), optional :: is_given(:)
      integer :: first(levels + 1), k, level, nodes

      nodes = tree%first(1) - 1
      first = tree%first(1:levels + 1) - nodes
      do k = 1, first(levels + 1) - 1   ! as an array each cell would be a call
         tree%seen(1, k) = 0.0_wp
         tree%seen(2, k) = 0.0_wp
      end do
      if (present(is_given)) then
         call leave_mixed(1.0_wp/resistance(0), given, is_given, tree%place, tree%parent, tree%seen)
      else
         call leave_nodes(1.0_wp/resistance(0), given, tree%place, tree%parent, tree%seen)
      end if
      do level = 1, levels - 1
         call lift(first(level), first(level + 1) - 1, resistance(level), &
            tree%parent(nodes + 1:), tree%seen)
      end do
      ! No current goes into the root, which has no resistor.
      associate (root => first(levels))
         tree%potential(root) = 0.0_wp
         if (tree%seen(1, root) > 0.0_wp) tree%potential(root) = tree%seen(2, root) &
            /tree%seen(1, root)
      end associate
      do level = levels - 1, 1, -1
         call lower(first(level), first(level + 1) - 1, resistance(level), &
            tree%parent(nodes + 1:), tree%seen, tree%potential)
      end do
      if (present(is_given)) then
         call reach_mixed(1.0_wp/resistance(0), given, is_given, tree%place, tree%parent, &
            tree%potential, tree%current)
      else
         call reach_nodes(1.0_wp/resistance(0), given, tree%place, tree%parent, tree%potential, &
            tree%current)
      end if
   end subroutine solve_tree

   !> Passes from the nodes, seen from beyond their resistors of `conductance`, to the cells above.
   pure subroutine leave_nodes(conductance, given, place, parent, seen)
      real(wp), intent(in) :: conductance
      real(wp), contiguous, intent(in) :: given(:)
      integer, contiguous, intent(in) :: place(:), parent(:)
      real(wp), contiguous, intent(inout) :: seen(:, :)
      integer :: k

      do k = 1, size(given)
         seen(1, parent(k)) = seen(1, parent(k)) + conductance
         seen(2, parent(k)) = seen(2, parent(k)) + conductance*given(place(k))
      end do
   end subroutine leave_nodes

   !> The same with some currents given.
   pure subroutine leave_mixed(conductance, given, is_given, place, parent, seen)
      real(wp), intent(in) :: conductance
      real(wp), contiguous, intent(in) :: given(:)
      logical, contiguous, intent(in) :: is_given(:)
      integer, contiguous, intent(in) :: place(:), parent(:)
      real(wp), contiguous, intent(inout) :: seen(:, :)
      integer :: k

      do k = 1, size(given)
         seen(1, parent(k)) = seen(1, parent(k)) + merge(0.0_wp, conductance, is_given(place(k)))
         seen(2, parent(k)) = seen(2, parent(k)) + merge(1.0_wp, conductance, &
            is_given(place(k)))*given(place(k))
      end do
   end subroutine leave_mixed

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

   !> Computes the currents into the nodes from the potentials above them.
   pure subroutine reach_nodes(conductance, given, place, parent, potential, current)
      real(wp), intent(in) :: conductance
      real(wp), contiguous, intent(in) :: given(:), potential(:)
      integer, contiguous, intent(in) :: place(:), parent(:)
      real(wp), contiguous, intent(inout) :: current(:)
      integer :: k

      do k = 1, size(given)
         current(k) = (conductance*given(place(k)) - conductance*potential(parent(k)))/trees
      end do
   end subroutine reach_nodes

   !> The same with some currents given.
   pure subroutine reach_mixed(conductance, given, is_given, place, parent, potential, current)
      real(wp), intent(in) :: conductance
      real(wp), contiguous, intent(in) :: given(:), potential(:)
      logical, contiguous, intent(in) :: is_given(:)
      integer, contiguous, intent(in) :: place(:), parent(:)
      real(wp), contiguous, intent(inout) :: current(:)
      integer :: k

      do k = 1, size(given)
         current(k) = (merge(1.0_wp, conductance, is_given(place(k)))*given(place(k)) &
            - merge(0.0_wp, conductance, is_given(place(k)))*potential(parent(k)))/trees
      end do
   end subroutine reach_mixed

end module tree_network
