!> How finely the grid and the time steps of a contact resolve the waves of its surfaces: ridges,
!> dents, sinusoids, profiles; chooses the time step accordingly.
!>
!> A wave that falls between the nodes, or passes within a step, is lost, and coarse runs do not
!> show the loss (theory page, section on domain and grid; docs/decisions.md).
module wave_resolution
   use duty, only: span_of
   use kinds, only: int64, wp
   use line_contact, only: finest_wave, rough_contact_t, shortest_passage, time_settings_t
   use text, only: add_sentence, rounded, to_text
   implicit none (type, external)
   private

   public :: choose_time_step, coarse_waves, intervals_at_least, long_steps, node_spacing, &
      nodes_in_wave, steps_in_wave, unseen_waves

   !> Nodes in the finest wave, and steps in which it passes a point, for 1 % in h_min: used by
   !> default and in notes.
   integer, parameter, public :: wanted_nodes = 32
   integer, parameter :: wanted_steps = 16
   !> Nodes (at rest, in time) and steps from which coarse runs resolve what this grid resolves;
   !> steps count only if longer than dX.
   real(wp), parameter :: seen_nodes(2) = [16.0_wp, 8.0_wp], seen_steps = 32.0_wp
   !> A feature or sinusoid with fewer nodes, or steps in its passage, is refused.
   real(wp), parameter, public :: min_in_a_wave = 2.0_wp
   !> Steps up to this many spacings are no longer than dX, except for rounding.
   real(wp), parameter :: long_step = 1.001_wp
   !> More steps than these make no difference.
   real(wp), parameter :: max_steps = 1.0e6_wp
   !> Numbers of intervals are one of these times a power of two.
   integer, parameter :: families(4) = [4, 5, 6, 7]
   !> Share of a step that is rounding: a step given to a few digits is not shortened for it.
   real(wp), parameter :: rounding = 1.0e-3_wp
   !> Steps in a table of a duty, and largest error of the parts that they are divided into,
   !> relative to the film.
   integer, parameter :: steps_in_duty = 400
   real(wp), parameter :: part_tolerance = 1.0e-4_wp

contains

   !> Nodes of a complete domain in the finest wave of the surfaces; huge if they are smooth.
   pure real(wp) function nodes_in_wave(contact) result(nodes)
      class(rough_contact_t), intent(in) :: contact

      nodes = huge(1.0_wp)
      if (contact%domain%grid == 'graded') return   ! its errors tell
      if (finest_wave(contact) < nodes) nodes = finest_wave(contact)/node_spacing(contact)
   end function nodes_in_wave

   !> Time steps in which the finest moving wave passes a point; huge without one, or if no step is
   !> known yet.
   pure real(wp) function steps_in_wave(contact, time) result(steps)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time

      steps = huge(1.0_wp)
      if (.not. time%is_transient .or. shortest_passage(contact) >= max_steps*time%time_step) return
      if (time%time_step > 0.0_wp) steps = shortest_passage(contact)/time%time_step
   end function steps_in_wave

   !> Note on waves with too few nodes or steps for 1 %, and what suffices; empty: none. Domain and
   !> time step must be complete.
   pure function coarse_waves(contact, time) result(words)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      character(:), allocatable :: words
      real(wp) :: nodes, steps

      nodes = nodes_in_wave(contact)
      steps = steps_in_wave(contact, time)
      words = ''
      if (nodes < wanted_nodes) words = 'the finest wave of the surfaces has '//to_text(nodes, 3) &
         //' nodes, '//to_text(wanted_nodes)//' are needed: ' &
         //to_text(intervals_at_least(real(wanted_nodes, wp)/nodes*contact%domain%intervals)) &
         //' intervals'
      if (steps < wanted_steps) call add_sentence(words, 'the finest moving wave passes in ' &
         //to_text(steps, 3)//' time steps, '//to_text(wanted_steps)// &
         ' are needed: time_step = '//rounded(shortest_passage(contact)/wanted_steps, 2, &
         up=.false.))
   end function coarse_waves

   !> Note that time steps are too long for an error estimate, and which are not; empty: they are
   !> not too long. Domain and time step must be complete.
   pure function long_steps(contact, time) result(words)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      character(:), allocatable :: words

      words = unseen_passage(contact, time)
      if (words /= '') words = 'the error is not estimated: '//words//': time_step = ' &
         //rounded(max(shortest_passage(contact)/seen_steps, node_spacing(contact)), 2, &
         up=.false.)
   end function long_steps

   !> Says that longer steps miss waves that these resolve; empty: they do not.
   pure function unseen_passage(contact, time) result(words)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      character(:), allocatable :: words
      real(wp) :: steps

      steps = steps_in_wave(contact, time)
      words = ''
      if (steps < seen_steps .and. time%time_step > long_step*node_spacing(contact)) words = &
         'the finest moving wave passes in '//to_text(steps, 3)//' time steps, an estimate '// &
         'needs '//to_text(nint(seen_steps))//', or steps of dX'
   end function unseen_passage

   !> Why coarser grids and longer steps give no error estimate: waves that they do not resolve.
   !> Empty: they do, or grid and step are not known yet.
   pure function unseen_waves(contact, time) result(words)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      character(:), allocatable :: words
      real(wp) :: least, nodes

      words = ''
      if (contact%domain%intervals <= 0) return
      words = unseen_passage(contact, time)
      least = seen_nodes(merge(2, 1, time%is_transient))
      nodes = nodes_in_wave(contact)
      if (nodes < least) words = 'the finest wave of the surfaces has '//to_text(nodes, 3) &
         //' nodes, an estimate needs '//to_text(nint(least))
   end function unseen_waves

   !> Smallest allowed number of intervals from `wanted` on.
   pure function intervals_at_least(wanted) result(intervals)
      real(wp), intent(in) :: wanted
      integer :: intervals, scale

      scale = 2
      do while (families(size(families))*real(scale, wp) < wanted .and. scale < 2**27)
         scale = 2*scale
      end do
      intervals = minval(scale*families, mask=scale*families >= wanted)
      if (wanted > families(size(families))*real(scale, wp)) intervals = families(size(families)) &
         *scale
   end function intervals_at_least

   !> dX of a complete domain.
   pure real(wp) function node_spacing(contact) result(spacing)
      class(rough_contact_t), intent(in) :: contact

      spacing = (contact%domain%x_outlet - contact%domain%x_inlet)/contact%domain%intervals
   end function node_spacing

   !> Sets the time step of a transient on a complete domain: the given one, or dX (with a duty a
   !> share of its table, and parts by an error estimate), but at least `wanted_steps` in the
   !> passage of the finest wave; shortened so that an integer number of steps ends at
   !> `time%end_time`, or makes a cycle. A steady case and a step already chosen do not change.
   pure subroutine choose_time_step(contact, time)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(inout) :: time
      real(wp) :: whole, wanted

      if (.not. (time%is_transient .and. time%end_time > 0.0_wp)) return
      wanted = time%time_step
      if (.not. wanted > 0.0_wp) then
         wanted = node_spacing(contact)
         if (allocated(contact%duty)) then
            wanted = span_of(contact%duty)/steps_in_duty
            if (time%scheme == 'bdf2') time%tolerance = part_tolerance
         end if
         wanted = min(wanted, shortest_passage(contact)/wanted_steps)
      end if
      whole = time%end_time
      if (time%may_lengthen) whole = span_of(contact%duty)
      time%time_step = whole/max(1_int64, ceiling(whole/wanted - rounding, int64))
   end subroutine choose_time_step

end module wave_resolution
