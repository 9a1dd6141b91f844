!> The arguments of the program.
module command_line
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use key_row, only: every, has_word
   use namelist_text, only: entry_t
   use number_text, only: read_integer
   use set_entries, only: new_set_entry
   use value_hints, only: nearest_known
   implicit none (type, external)
   private

   public :: command_t, read_command_line, help_text

   !> What the user asks for.
   type :: command_t
      !> 'run', 'check', 'table', 'template', 'keys', 'keys-markdown', 'version' or 'help'.
      character(:), allocatable :: action
      !> Problem of the template.
      character(:), allocatable :: problem
      !> Form of the table: 'text', 'csv', 'json' or 'profiles', those of one result.
      character(len=8) :: form = 'text'
      !> Namelist files; of a table results.
      character(len=4096), allocatable :: files(:)
      !> Folder of the results; empty: not given.
      character(:), allocatable :: output_dir
      !> Table that gets a row for each case in place of results; empty: none.
      character(:), allocatable :: summary
      !> Threads of areal problems [-].
      integer :: threads = 1
      !> Options without a value, as they are given.
      character(len=16), allocatable :: flags(:)
      !> Entries that replace or complete those of every namelist.
      type(entry_t), allocatable :: entries(:)
   contains
      procedure :: has
   end type command_t

   !> Options with a value behind them, without one, and those that say what to do.
   character(len=16), parameter :: with_value(*) = [character(len=16) :: '--output', '--threads', &
      '--set', '--format', '--summary', '--template'], flags(*) = [character(len=16) :: &
      '--resume', '--outcomes', '--keep-going', '--profiles', '--quiet', '--verbose'], &
      actions(*) = [character(len=16) :: '--check', '--keys', '--version', '--help', &
      '--keys-markdown']
   !> Most threads that can be asked for.
   integer, parameter :: max_threads = 9999
   character(*), parameter :: see_help = '; see asperity --help'

contains

   !> Reads the arguments of the process. Errors (input_error): bad or incomplete options, no case.
   subroutine read_command_line(command, error)
      type(command_t), intent(out) :: command
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: word
      integer :: i, count, files

      command%action = 'run'
      command%output_dir = ''
      command%summary = ''
      count = command_argument_count()
      allocate (command%files(count), command%flags(0), command%entries(0))
      files = 0
      i = 1
      do while (i <= count)
         word = argument(i)
         if (any(word == ['-h  ', 'help'])) word = '--help'
         if (any(word == actions)) then
            call set_action(command, word(3:), error)
         else if (word == 'table' .and. i == 1) then
            command%action = 'table'
         else if (any(word == flags)) then
            command%flags = [character(len=16) :: command%flags, word]
         else if (any(word == with_value)) then
            i = i + 1
            call read_option_value(command, word, argument(i), error)
         else
            call read_file_name(command, word, files, error)
         end if
         if (allocated(error)) return
         i = i + 1
      end do
      command%files = command%files(:files)
      if (command%has('--profiles')) command%form = 'profiles'
      if (command%form == 'profiles' .and. .not. (command%action == 'table' .and. files == 1)) then
         call fail(error, input_error, 'found --profiles, expected asperity table RESULT.h5 '// &
            '--profiles with one result'//see_help)
         return
      end if
      if (command%summary /= '' .and. command%output_dir /= '') call fail(error, input_error, &
         'found --summary and --output, expected one of them: a table has no results beside it')
      if (size(command%files) > 0 .or. allocated(error)) return
      if (any(command%action == ['run  ', 'check'])) call fail(error, input_error, &
         'found no namelist file, expected at least one' // see_help)
      if (command%action == 'table') call fail(error, input_error, &
         'found no result, expected at least one' // see_help)
   end subroutine read_command_line

   !> Whether an `option` without a value is given.
   pure logical function has(self, option)
      class(command_t), intent(in) :: self
      character(*), intent(in) :: option

      has = any(self%flags == option)
   end function has

   !> Argument number `i`; empty if there is none.
   function argument(i) result(word)
      integer, intent(in) :: i
      character(:), allocatable :: word
      integer :: length

      length = 0
      if (i <= command_argument_count()) call get_command_argument(i, length=length)
      allocate (character(len=length) :: word)
      if (length > 0) call get_command_argument(i, value=word)
   end function argument

   !> One action a call. Error: a second, different one.
   subroutine set_action(command, action, error)
      type(command_t), intent(inout) :: command
      character(*), intent(in) :: action
      type(error_t), allocatable, intent(out) :: error

      if (command%action /= 'run' .and. command%action /= action) then
         call fail(error, input_error, 'found --' // command%action // ' and '// &
            '--' // action // ', expected one of them')
         return
      end if
      command%action = action
   end subroutine set_action

   !> The word after an option. Errors: missing, not a number of threads, no entry, not a problem.
   subroutine read_option_value(command, option, value, error)
      type(command_t), intent(inout) :: command
      character(*), intent(in) :: option, value
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: threads
      type(entry_t) :: entry
      logical :: good

      if (len_trim(value) == 0) then
         call fail(error, input_error, 'found ' // option // ' without a value' // see_help)
         return
      end if
      select case (option)
      case ('--output')
         command%output_dir = value
      case ('--summary')
         command%summary = value
         if (index(value, '.h5', back=.true.) > max(0, len(value) - 3)) call fail(error, &
            input_error, 'found --summary '//value//', expected a name as TABLE.csv: lines of '// &
            'text, which processes can share and no kill damages; batch/gather.py turns those '// &
            'of a sweep into HDF5')
      case ('--format')
         command%form = value
         if (all(value /= ['text', 'csv ', 'json'])) call fail(error, input_error, &
            'found --format ' // value // ', expected text, csv or json')
      case ('--set')
         call new_set_entry(entry, value, error)
         if (.not. allocated(error)) command%entries = [command%entries, entry]
      case ('--threads')
         call read_integer(value, threads, good)
         if (good .and. threads >= 1 .and. threads <= max_threads) then
            command%threads = int(threads)
         else
            call fail(error, input_error, 'found --threads ' // value // ', expected a number '// &
               'of threads, 1 to 9999')
         end if
      case default
         call set_action(command, 'template', error)
         if (allocated(error)) return
         command%problem = value
         if (has_word(every, value)) return
         call fail(error, input_error, 'found --template ' // value // ', expected ehl_line, '// &
            'ehl_point, dry_line or dry_area')
      end select
   end subroutine read_option_value

   !> Adds a file to this many `files`. Error: an unknown option; a name that is too long.
   subroutine read_file_name(command, word, files, error)
      type(command_t), intent(inout) :: command
      character(*), intent(in) :: word
      integer, intent(inout) :: files
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: hint

      if (index(word, '-') == 1) then
         hint = nearest_known(word, [with_value, flags, actions(:4)])
         if (hint /= '') hint = '; did you mean ' // hint // '?'
         call fail(error, input_error, 'found the unknown option ' // word // hint // see_help)
      else if (len(word) > len(command%files)) then
         call fail(error, input_error, 'found a file name of more than 4096 characters')
      else
         files = files + 1
         command%files(files) = word
      end if
   end subroutine read_file_name

   !> What `--help` shows.
   pure function help_text() result(text)
      character(:), allocatable :: text
      character(*), parameter :: nl = new_line('a')

      text = 'asperity - contacts between rough surfaces: lubricated (elastohydrodynamic) '// &
         'lines and points, dry profiles and areas' // nl &
         // nl &
         // 'Usage:' // nl &
         // '  asperity CASE.nml [CASE2.nml ...] [--output DIR] [--threads N] [--check] '// &
            '[--resume] [--keep-going]' // nl &
         // '           [--set GROUP.KEY=VALUE] [--quiet] [--outcomes] '// &
            '[--summary TABLE.csv]' // nl &
         // '  asperity table RESULT.h5 [RESULT2.h5 ...] [--format text|csv|json]    a row of '// &
         'each result' // nl &
         // '  asperity table RESULT.h5 --profiles      CSV of x, pressure, film or gap and '// &
         'more, in SI' // nl &
         // '  asperity --template PROBLEM      write a commented, complete namelist: '// &
            'ehl_line, ehl_point, dry_line or dry_area' // nl &
         // '  asperity --keys                  every group and key: unit, default, range, '// &
            'meaning' // nl &
         // '  asperity --version | --help' // nl // nl &
         // 'Options:' // nl &
         // '  --output DIR   folder of the results, made if it is not there; without it the '// &
            'current one (or output of the case)' // nl &
         // '  --summary TABLE.csv   appends a row of numbers for each case to a table, in '// &
            'place of results: no fields, no checkpoints' // nl &
         // '  --set GROUP.KEY=VALUE   replaces or adds an entry of every namelist; may be '// &
            'given several times' // nl &
         // '  --keep-going   runs the good ones of several cases where others have bad input '// &
            '(status 1)' // nl &
         // '  --check        read and check the namelists, compute nothing' // nl &
         // '  --quiet        no progress; errors only' // nl &
         // '  --verbose      more than twelve lines at the end: dimensionless values, '// &
            'handbook films, residuals, every limit' // nl &
         // '  --outcomes     a line for each case on standard output when it ends: status, '// &
            'namelist, reason (tabs between)' // nl &
         // '  --threads N    threads of areas and points (default 1), at most as many as '// &
            'processors; of passages of lines two, one for error bars' // nl &
         // '  --resume       go on where an interrupted run of the same cases left off' // nl &
            // nl &
         // 'Examples:' // nl &
         // '  asperity --template ehl_line > case.nml && asperity case.nml        first run, '// &
            'writes case.h5' // nl &
         // '  asperity --check case.nml                                          what is '// &
            'wrong with my input?' // nl &
         // '  asperity case.nml --set bodies.speed_1=2.5 --set case.title=fast    one value '// &
            'changed' // nl &
         // '  asperity load*.nml --output results --quiet                        several '// &
            'cases, one after another' // nl &
         // '  ls *.nml | xargs -P 8 -n 1 asperity --quiet                        side by '// &
            'side on 8 cores' // nl // nl &
         // 'Exit status: 0 every case converged and was written; 1 bad input, usage or file; '// &
            '2 a case did not converge' // nl &
         // 'or left the model (written, marked, with the reason); 3 a result could not be '// &
            'written; 4 interrupted by a' // nl &
         // 'signal, checkpoint written. Results go to files, summaries to standard output, '// &
            'progress and errors to' // nl &
         // 'standard error.' // nl
   end function help_text

end module command_line
