!> Sums over any number of heights on a uniform grid, gathered block by block, and their results:
!> mean, tilt and curvature by least squares, slopes, whether the heights close on themselves.
!>
!> With s and t from -1 to 1 over the first and the last node, the form is the polynomial
!>
!>     a1 + a2 s + a3 t + a4 (s^2 - <s^2>) + a5 s t + a6 (t^2 - <t^2>)
!>
!> whose terms are orthogonal on the grid, so each coefficient is a quotient of two sums.
module height_form
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: closes, curvature_of, extent_of, form_of, form_t, height_sums_t, &
      rms_height, rms_slope, subtract_form, tilt_of, trend_t

   !> Heights close if the rms step across their ends is at most this many times one inside.
   real(wp), parameter :: largest_step = 3.0_wp

   !> Sums over the heights so far, each less the first one.
   type :: height_sums_t
      !> nx, ny (ny = 1: a profile), and the heights so far.
      integer(int64) :: grid(2) = 0_int64, nodes = 0_int64
      real(wp) :: first = 0.0_wp, lowest = huge(1.0_wp), highest = -huge(1.0_wp)
      !> Sums of 1, s, t, s^2, s t, t^2 times the height.
      real(wp) :: moments(6) = 0.0_wp
      !> Sums of squares, and of squared steps between neighbours in x and y.
      real(wp) :: squares = 0.0_wp, steps(2) = 0.0_wp
      !> Sums of the squared steps from the last to the first node of every row and column.
      real(wp) :: squared_jumps(2) = 0.0_wp
      !> The previous height.
      real(wp), private :: before = 0.0_wp
   contains
      procedure :: add
   end type height_sums_t

   !> The form: coefficients [m] as above.
   type :: form_t
      real(wp) :: terms(6) = 0.0_wp
      integer(int64) :: grid(2) = 0_int64
   end type form_t

   !> What was subtracted from the heights of a file.
   type :: trend_t
      !> 'none', 'mean', 'line' or 'parabola'; empty: no file.
      character(len=8) :: word = ''
      type(form_t) :: form
      !> Spacing of the nodes in x and y [m].
      real(wp) :: spacing(2) = 0.0_wp
   end type trend_t

contains

   !> Adds the next heights [m], x fastest; for an area all of them at once.
   pure subroutine add(self, z)
      class(height_sums_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), allocatable :: place(:)
      integer(int64) :: j, row
      integer :: k

      if (self%nodes == 0_int64) then
         self%first = z(1)
         self%before = z(1)
      end if
      if (self%grid(2) == 1_int64) then
         place = coordinate(self%nodes + [(k - 1, k=1, size(z))], self%grid(1))
         call add_row(self, 0_int64, place, z)
         self%nodes = self%nodes + size(z, kind=int64)
         self%squared_jumps(1) = (self%first - self%before)**2
         return
      end if
      row = self%grid(1)
      place = coordinate([(j, j=0, row - 1)], row)
      do j = 0, self%grid(2) - 1
         associate (this => z(j*row + 1:(j + 1)*row), below => z(modulo(j - 1, &
            self%grid(2))*row + 1:(modulo(j - 1, self%grid(2)) + 1)*row))
            self%before = this(1)
            call add_row(self, j, place, this)
            self%squared_jumps(1) = self%squared_jumps(1) + (this(1) - this(row))**2
            if (j > 0) then
               self%steps(2) = self%steps(2) + sum((this - below)**2)
            else
               self%squared_jumps(2) = sum((this - below)**2)
            end if
         end associate
      end do
      self%nodes = size(z, kind=int64)
   end subroutine add

   !> Adds heights of row `j` (from 0) at the positions s.
   pure subroutine add_row(sums, j, s, z)
      type(height_sums_t), intent(inout) :: sums
      integer(int64), intent(in) :: j
      real(wp), contiguous, intent(in) :: s(:), z(:)
      real(wp) :: highest, lowest, of_one, of_s, of_s2, squares, steps, t, value
      integer :: k

      of_one = 0.0_wp
      of_s = 0.0_wp
      of_s2 = 0.0_wp
      steps = sum((z(2:) - z(:size(z) - 1))**2)
      squares = sums%squares
      lowest = sums%lowest
      highest = sums%highest
      t = coordinate(j, sums%grid(2))
      !$omp simd reduction(+:of_one, of_s, of_s2, squares) reduction(min:lowest) &
      !$omp reduction(max:highest)
      do k = 1, size(z)
         lowest = min(lowest, z(k))
         highest = max(highest, z(k))
         value = z(k) - sums%first
         of_one = of_one + value
         of_s = of_s + s(k)*value
         of_s2 = of_s2 + s(k)**2*value
         squares = squares + value**2
      end do
      sums%lowest = lowest
      sums%highest = highest
      sums%squares = squares
      sums%moments = sums%moments + [of_one, of_s, t*of_one, of_s2, t*of_s, t**2*of_one]
      sums%steps(1) = sums%steps(1) + (z(1) - sums%before)**2 + steps
      sums%before = z(size(z))
   end subroutine add_row

   !> Position of node `i` (from 0) of `n`, from -1 to 1; 0 for a single node.
   pure elemental real(wp) function coordinate(i, n) result(s)
      integer(int64), intent(in) :: i, n

      s = real(2*i - (n - 1), wp)/real(max(n - 1, 1_int64), wp)
   end function coordinate

   !> The mean squares of the six terms, from the means of s^2 and of (s^2 - <s^2>)^2.
   pure function norms_of(grid) result(norms)
      integer(int64), intent(in) :: grid(2)
      real(wp) :: norms(6), fourth(2), nodes(2), second(2)

      nodes = real(grid, wp)
      second = 0.0_wp
      fourth = 0.0_wp
      where (grid > 1_int64) second = (nodes + 1.0_wp)/(3.0_wp*(nodes - 1.0_wp))
      where (grid > 2_int64) fourth = second*((3.0_wp*nodes**2 - 7.0_wp)/(5.0_wp*(nodes &
         - 1.0_wp)**2) - second)
      norms = [1.0_wp, second(1), second(2), fourth(1), second(1)*second(2), fourth(2)]
   end function norms_of

   !> Least-squares form: zero (`degree` -1), the mean (0), with the tilts (1), with curvatures (2).
   pure function form_of(sums, degree) result(form)
      type(height_sums_t), intent(in) :: sums
      integer, intent(in) :: degree
      type(form_t) :: form
      integer, parameter :: terms(0:2) = [1, 3, 6]
      real(wp) :: norms(6)

      form%grid = sums%grid
      if (degree < 0) return
      norms = norms_of(sums%grid)
      form%terms = sums%moments
      form%terms(4) = form%terms(4) - norms(2)*sums%moments(1)
      form%terms(6) = form%terms(6) - norms(3)*sums%moments(1)
      where (norms > 0.0_wp)
         form%terms = form%terms/(norms*real(sums%nodes, wp))
      else where
         form%terms = 0.0_wp
      end where
      form%terms(terms(degree) + 1:) = 0.0_wp
      form%terms(1) = form%terms(1) + sums%first
   end function form_of

   !> Subtracts a form from the heights [m] from number `first` (from 0) on.
   pure subroutine subtract_form(form, first, z)
      type(form_t), intent(in) :: form
      integer(int64), intent(in) :: first
      real(wp), intent(inout) :: z(:)
      real(wp) :: norms(6), s, t
      integer(int64) :: node
      integer :: k

      if (all(abs(form%terms) <= 0.0_wp)) return
      norms = norms_of(form%grid)
      t = 0.0_wp
      do k = 1, size(z)
         node = first + k - 1
         if (form%grid(2) > 1_int64) then
            t = coordinate(node/form%grid(1), form%grid(2))
            node = modulo(node, form%grid(1))
         end if
         s = coordinate(node, form%grid(1))
         associate (a => form%terms)
            z(k) = z(k) - (a(1) + s*(a(2) + s*a(4) + t*a(5)) + t*(a(3) + t*a(6)) &
               - (a(4)*norms(2) + a(6)*norms(3)))
         end associate
      end do
   end subroutine subtract_form

   !> Lengths [m] from the first node to the last in x and y; 0 across a profile.
   pure function extent_of(trend) result(extent)
      type(trend_t), intent(in) :: trend
      real(wp) :: extent(2)

      extent = (trend%form%grid - 1)*trend%spacing
   end function extent_of

   !> Tilts [-] that were subtracted, in x and y.
   pure function tilt_of(trend) result(tilt)
      type(trend_t), intent(in) :: trend
      real(wp) :: tilt(2)

      tilt = 0.0_wp
      where (extent_of(trend) > 0.0_wp) tilt = 2.0_wp*trend%form%terms(2:3)/extent_of(trend)
   end function tilt_of

   !> Curvatures d2z/dx2, d2z/dy2 [1/m] that were subtracted.
   pure function curvature_of(trend) result(curvature)
      type(trend_t), intent(in) :: trend
      real(wp) :: curvature(2)

      curvature = 0.0_wp
      where (extent_of(trend) > 0.0_wp) curvature = 8.0_wp*trend%form%terms(4:6:2) &
         /extent_of(trend)**2
   end function curvature_of

   !> Rms height [m] without the form.
   pure function rms_height(sums, form) result(rms)
      type(height_sums_t), intent(in) :: sums
      type(form_t), intent(in) :: form
      real(wp) :: rms, terms(6)

      terms = form%terms
      terms(1) = sums%moments(1)/real(sums%nodes, wp)   ! the mean never counts
      rms = sqrt(max(0.0_wp, sums%squares/real(sums%nodes, wp) - sum(terms**2*norms_of(sums%grid))))
   end function rms_height

   !> Rms slopes [-] in x and y of neighbours `spacing` [m] > 0 apart; 0 across a profile.
   pure function rms_slope(sums, spacing) result(slope)
      type(height_sums_t), intent(in) :: sums
      real(wp), intent(in) :: spacing(2)
      real(wp) :: slope(2)

      slope = rms_step(sums)
      where (slope > 0.0_wp) slope = slope/spacing
   end function rms_slope

   !> Rms step [m] between neighbours in x and y.
   pure function rms_step(sums) result(step)
      type(height_sums_t), intent(in) :: sums
      real(wp) :: step(2)
      integer(int64) :: number(2)

      number = [(sums%grid(1) - 1)*sums%grid(2), sums%grid(1)*(sums%grid(2) - 1)]
      step = sqrt(sums%steps/real(max(number, 1_int64), wp))
   end function rms_step

   !> Whether the heights can be repeated: the step from end to beginning is like those inside.
   pure logical function closes(sums)
      type(height_sums_t), intent(in) :: sums
      real(wp) :: jump(2)

      jump = sqrt(sums%squared_jumps/real(sums%grid(2:1:-1), wp))
      closes = all(jump <= largest_step*rms_step(sums) .or. sums%grid == 1_int64)
   end function closes

end module height_form
