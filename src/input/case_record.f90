!> One case as the user describes it, in SI, and the name of its result file.
module case_record
   use bodies, only: bodies_t
   use dry_case, only: dry_case_t
   use features, only: rough_surface_t
   use kinds, only: wp
   use lubricant, only: lubricant_t
   use solver_settings, only: domain_t, time_settings_t, solver_settings_t, word_length
   implicit none (type, external)
   private

   public :: accuracy_t, beside_namelist, case_identity, case_t, effective_t, output_settings_t, &
      result_path, set_effective

   !> A value that is used, given or default, for /input/effective/<group>/<key> of the result.
   type :: effective_t
      character(:), allocatable :: group, key
      !> Real numbers with 17 digits; several values separated by a comma.
      character(:), allocatable :: value
      !> SI unit, '-' for pure numbers, empty for words.
      character(:), allocatable :: unit
   end type effective_t

   !> What is stored of a transient.
   type :: output_settings_t
      !> Every how many time steps profiles are stored [-].
      integer :: profile_stride
      !> Stored profiles: 'pressure', 'film_thickness'.
      character(len=word_length), allocatable :: fields(:)
      !> Wall time between checkpoints [s].
      real(wp) :: checkpoint_interval
      !> Films for the statistics [m]; none: no statistics.
      real(wp), allocatable :: film_thresholds(:)
   end type output_settings_t

   !> What is asked of the accuracy.
   type :: accuracy_t
      !> Relative error of h_min for which the program chooses intervals and time step; 0: not
      !> asked.
      real(wp) :: target
      !> Companions on coarser grids are run for error estimates.
      logical :: has_error_bars
   end type accuracy_t

   !> One case. Made by `read_case` of module case_input.
   type :: case_t
      !> Free text of the user, UTF-8.
      character(:), allocatable :: title
      !> 'ehl_line', 'dry_line' or 'dry_area'.
      character(len=word_length) :: problem
      !> 'full'.
      character(len=word_length) :: model
      !> Result file as given, empty if not; see `result_path`.
      character(:), allocatable :: output
      !> Name of the namelist file.
      character(:), allocatable :: file
      !> Its text, byte for byte.
      character(:), allocatable :: namelist
      !> True if given by Moes' numbers: then bodies, load and ambient viscosity are unknown (zero).
      logical :: has_moes
      !> M and L [-], mean velocity.
      real(wp) :: moes_m, moes_l
      type(bodies_t) :: bodies
      type(lubricant_t) :: lubricant
      !> w [N/m].
      real(wp) :: load_per_length
      !> Amplitude and wavelength [m], position [half-widths], speed [m/s].
      type(rough_surface_t) :: surface_1, surface_2
      type(domain_t) :: domain
      type(time_settings_t) :: time
      type(solver_settings_t) :: solver
      type(output_settings_t) :: output_settings
      !> Filled for dry problems, which use nothing of the above but title, problem, model, output,
      !> file and namelist.
      type(dry_case_t) :: dry
      type(accuracy_t) :: accuracy
      !> Every value used, given or default or derived.
      type(effective_t), allocatable :: effective(:)
   end type case_t

contains

   !> File of the result: `output` of the case, relative to the namelist, else the namelist's
   !> stem + .h5 in the current folder. A folder `output_dir` (empty: none) replaces the folder of
   !> either.
   pure function result_path(case, output_dir) result(path)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: output_dir
      character(:), allocatable :: path
      integer :: point

      if (len(case%output) > 0) then
         path = case%output
         if (output_dir == '') path = beside_namelist(case, path)
      else
         path = case%file(index(case%file, '/', back=.true.) + 1:)
         point = index(path, '.', back=.true.)
         if (point > 1) path = path(:point - 1)
         path = path // '.h5'
      end if
      if (output_dir /= '') path = output_dir // '/' // path(index(path, '/', back=.true.) + 1:)
   end function result_path

   !> A path that a namelist gives, relative to the folder of the namelist.
   pure function beside_namelist(case, name) result(path)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: name
      character(:), allocatable :: path

      path = name
      if (index(path, '/') /= 1) path = case%file(:index(case%file, '/', back=.true.)) // path
   end function beside_namelist

   !> The values that decide about the result of a case, one a line. Before anything is chosen by
   !> the program.
   pure function case_identity(case) result(lines)
      type(case_t), intent(in) :: case
      character(:), allocatable :: lines
      integer :: i

      lines = '&case problem = '//trim(case%problem)
      do i = 1, size(case%effective)
         associate (entry => case%effective(i))
            if (entry%group == 'case' .or. entry%key == 'checkpoint_interval') cycle
            lines = lines//new_line('a')//'&'//entry%group//' '//entry%key//' = '//entry%value
         end associate
      end do
   end function case_identity

   !> Sets or adds a value in the list of effective values, for instance one that the program has
   !> chosen.
   pure subroutine set_effective(case, group, key, value, unit)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group, key, value, unit
      type(effective_t), allocatable :: longer(:)
      integer :: i, count

      if (.not. allocated(case%effective)) allocate (case%effective(0))
      do i = 1, size(case%effective)
         if (case%effective(i)%group /= group .or. case%effective(i)%key /= key) cycle
         case%effective(i)%value = value
         case%effective(i)%unit = unit
         return
      end do
      count = size(case%effective)
      allocate (longer(count + 1))
      longer(:count) = case%effective
      longer(count + 1)%group = group
      longer(count + 1)%key = key
      longer(count + 1)%value = value
      longer(count + 1)%unit = unit
      call move_alloc(longer, case%effective)
   end subroutine set_effective

end module case_record
