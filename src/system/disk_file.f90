!> Files and folders by their paths, of which two name one file if device and inode agree. This
!> program replaces and removes only files that it has written, safe against a crash and against
!> other runs: they are known by a mark in their bytes, also if damaged or half-written.
module disk_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_loc, c_null_char, c_short, &
      c_size_t
   use build_info, only: program_name
   use c_library, only: c_close, c_fcntl, c_fsync, c_ftruncate, c_lseek, c_mkdir, c_open, c_pread, &
      c_rename, c_statx, c_unlink, c_write, file_lock_t, statx_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: append_line, file_at, file_fault, folder_of, is_folder, lock_t, make_folder, mark_of, &
      place_fault, remove_file, rename_file, sync_file

   !> What a path leads to; `kind_other`: a pipe, a device, a socket.
   integer, parameter, public :: kind_missing = 0, kind_regular = 1, kind_link = 3, kind_other = 4
   integer, parameter :: kind_folder = 2

   !> A file as the operating system knows it; what cannot be looked at is missing.
   type, public :: file_identity_t
      integer :: kind = kind_missing
      !> Device and inode.
      character(len=64) :: word = ''
   end type file_identity_t

   !> AT_FDCWD, AT_SYMLINK_NOFOLLOW, AT_EMPTY_PATH, STATX_BASIC_STATS.
   integer(c_int), parameter :: current_folder = -100_c_int, no_follow = 256_c_int, &
      empty_path = 4096_c_int, basic = 2047_c_int
   !> The part of the mode that is the kind of file (S_IFMT), and its values for kinds 1 to 3.
   integer, parameter :: kind_bits = 61440, bits_of_kinds(3) = [32768, 16384, 40960]

   !> What a file is marked as: not at all; an HDF5 file; an XDMF file; nothing is in it yet, which
   !> a run that was killed may leave; time steps. `any_mark`: any of them.
   integer, parameter, public :: no_mark = 0, hdf5_mark = 1, xdmf_mark = 2, any_mark = 3
   integer, parameter :: empty_mark = 4, part_mark = 5
   !> The marks: the attribute `program` of HDF5 files, and where it is written before the library
   !> writes anything [bytes]; the first words of a seal, of an XDMF file, of one with time steps.
   character(len=*), parameter :: attribute = 'program'//c_null_char
   character(len=*), parameter, public :: early_words = attribute//repeat(c_null_char, &
      16)//program_name
   integer(c_int64_t), parameter, public :: early_place = 840_c_int64_t
   character(len=*), parameter, public :: seal_words = program_name//' checksum ', &
      xdmf_words = '<!-- made by '//program_name, part_words = program_name//' series '
   !> From the name of the attribute to the end of its value, at most; an HDF5 file (superblock of
   !> version 0) that holds nothing; a seal [bytes].
   integer, parameter :: attribute_bytes = 64, empty_bytes = 800
   character(len=*), parameter :: signature = char(137)//'HDF'//achar(13)//achar(10)//achar(26) &
      //achar(10)//c_null_char
   integer, parameter, public :: seal_bytes = 80
   !> Bytes that are looked at; of a table more than a line has.
   integer, parameter :: head_bytes = 4096, tail_bytes = 65536
   !> O_RDONLY, O_RDWR + O_APPEND; O_RDONLY + O_NONBLOCK: a pipe waits for no writer; SEEK_END.
   integer(c_int), parameter :: read_only = 0_c_int, read_and_append = 1026_c_int, &
      read_at_once = 2048_c_int, from_end = 2_c_int
   !> F_OFD_SETLK, a lock that other descriptors do not end; F_OFD_SETLKW waits; F_WRLCK, F_UNLCK.
   integer(c_int), parameter :: set_lock = 37_c_int, wait_for_lock = 38_c_int
   integer(c_short), parameter :: lock_to_write = 1_c_short, lock_none = 2_c_short

   !> A lock on a file, held until `release` or the end of the process, however that comes.
   type :: lock_t
      integer(c_int), private :: descriptor = -1_c_int, operation = set_lock
   contains
      procedure :: acquire, holds, release
   end type lock_t

contains

   !> Why a file of this `mark` may not take the place `path`, or with `any_mark` why the file there
   !> may not be removed; empty: it may.
   function place_fault(path, mark) result(fault)
      character(*), intent(in) :: path
      integer, intent(in) :: mark
      character(:), allocatable :: fault
      type(file_identity_t) :: file
      integer :: found

      fault = ''
      file = file_at(path, follows=.true.)
      if (file%kind /= kind_regular) return
      found = mark_of(path//c_null_char)
      if (found == mark .or. (mark == any_mark .and. found /= no_mark)) return
      fault = ': it is there, and '//program_name//' has not written it'
   end function place_fault

   !> The mark of the file `path` (with a zero at its end), found without allocating: for handlers.
   recursive integer function mark_of(path) result(mark)
      character(kind=c_char), intent(in) :: path(*)
      character(kind=c_char, len=head_bytes), target :: head
      integer(c_int64_t) :: bytes
      integer(c_int) :: descriptor, status
      integer :: length, place

      mark = no_mark
      descriptor = c_open(path, read_at_once)
      if (descriptor < 0_c_int) return
      bytes = c_lseek(descriptor, 0_c_int64_t, from_end)
      length = int(c_pread(descriptor, c_loc(head), int(head_bytes, c_size_t), 0_c_int64_t))
      place = index(head(:length), attribute)
      if (place > 0) then
         if (index(head(place:min(place + attribute_bytes, length)), program_name) > 0) mark = &
            hdf5_mark
      end if
      if (index(head(:length), xdmf_words) > 0) mark = xdmf_mark
      if (index(head(:length), part_words) == 1) mark = part_mark
      if (bytes == 0_c_int64_t .or. (bytes <= empty_bytes .and. index(head(:length), signature) &
         == 1)) mark = empty_mark
      if (mark == no_mark .and. bytes > seal_bytes) then
         length = int(c_pread(descriptor, c_loc(head), int(seal_bytes, c_size_t), &
            bytes - seal_bytes))
         if (index(head(:length), seal_words) == 1) mark = hdf5_mark
      end if
      status = c_close(descriptor)
   end function mark_of

   !> Renames a file in one step, replacing only one of this program; true if that worked.
   logical function rename_file(old, new) result(is_done)
      character(*), intent(in) :: old, new

      is_done = place_fault(new, mark_of(old//c_null_char)) == ''
      if (is_done) is_done = c_rename(old//c_null_char, new//c_null_char) == 0_c_int
   end function rename_file

   !> Removes a file that this program has written; true if that worked.
   logical function remove_file(path) result(is_done)
      character(*), intent(in) :: path

      is_done = place_fault(path, any_mark) == ''
      if (is_done) is_done = c_unlink(path//c_null_char) == 0_c_int
   end function remove_file

   !> Waits until everything written to a file, or the names in a folder, are on the disk; true if
   !> that worked (some file systems cannot do it for folders).
   logical function sync_file(path) result(is_done)
      character(*), intent(in) :: path
      integer(c_int) :: descriptor, status

      descriptor = c_open(path//c_null_char, read_only)
      is_done = descriptor >= 0_c_int
      if (.not. is_done) return
      is_done = c_fsync(descriptor) == 0_c_int
      status = c_close(descriptor)
   end function sync_file

   !> Appends a `line` with its end to the table `path` with the first line `head`, under a lock,
   !> for which it waits: rows of all processes stay whole, half a line is cut. `fault`: why not.
   function append_line(path, head, line) result(fault)
      character(*), intent(in) :: path, head, line
      character(:), allocatable :: fault, text
      character(kind=c_char, len=tail_bytes), target :: found
      type(lock_t) :: lock
      integer(c_int64_t) :: bytes, start
      integer :: length
      logical :: is_done

      lock%operation = wait_for_lock
      is_done = lock%acquire(path)
      fault = 'it cannot be opened'
      if (lock%descriptor < 0_c_int) return
      fault = 'its first line is not that of this table: another file or problem or version'
      length = int(c_pread(lock%descriptor, c_loc(found), len(head, c_size_t), 0_c_int64_t))
      if (length >= 0 .and. found(:length) == head(:length)) then
         fault = 'no space (the disk is full, or a quota or a limit on the size of files is '// &
            'reached)'
         start = 0_c_int64_t
         text = head//line
         if (length == len(head)) then   ! behind the last line that ends
            text = line
            bytes = c_lseek(lock%descriptor, 0_c_int64_t, from_end)
            start = max(bytes - tail_bytes, 0_c_int64_t)
            length = int(c_pread(lock%descriptor, c_loc(found), int(tail_bytes, c_size_t), start))
            start = start + index(found(:length), new_line('a'), back=.true.)
            if (length < 0) start = bytes
         end if
         is_done = c_ftruncate(lock%descriptor, start) == 0_c_int
         if (is_done) is_done = c_write(lock%descriptor, text, len(text, c_size_t)) == len(text)
         if (is_done) fault = ''
         if (.not. is_done) length = c_ftruncate(lock%descriptor, start)
      end if
      call lock%release()
   end function append_line

   !> Takes the lock on `path` for writing, making the file if there is none; false if another run
   !> has it. A file system that knows no locks counts as taken. If the file was renamed or removed
   !> between opening and locking, the lock is tried again.
   logical function acquire(self, path) result(is_taken)
      class(lock_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status, unit

      is_taken = .true.
      do
         call self%release()
         open (newunit=unit, file=path, access='stream', form='unformatted', action='readwrite', &
            iostat=status)
         if (status == 0) close (unit, iostat=status)
         if (status /= 0) return
         self%descriptor = c_open(path//c_null_char, read_and_append)
         if (self%descriptor < 0_c_int) cycle
         if (c_fcntl(self%descriptor, self%operation, file_lock_t(lock_to_write)) /= 0_c_int) exit
         if (self%holds(path)) return
      end do
      ! releasing what one does not have always works
      is_taken = c_fcntl(self%descriptor, set_lock, file_lock_t(lock_none)) /= 0_c_int
      if (.not. is_taken) call self%release()
   end function acquire

   !> Whether `path` still leads to the locked file.
   logical function holds(self, path)
      class(lock_t), intent(in) :: self
      character(*), intent(in) :: path
      type(file_identity_t) :: locked, there

      locked = query(self%descriptor, '', empty_path)
      there = file_at(path, follows=.true.)
      holds = there%kind /= kind_missing .and. locked%word == there%word
   end function holds

   !> Gives the lock back; twice does nothing.
   subroutine release(self)
      class(lock_t), intent(inout) :: self
      integer(c_int) :: status

      if (self%descriptor >= 0_c_int) status = c_close(self%descriptor)
      self%descriptor = -1_c_int
   end subroutine release

   !> What `path` leads to, or with `follows` false a link itself.
   function file_at(path, follows) result(identity)
      character(*), intent(in) :: path
      logical, intent(in) :: follows
      type(file_identity_t) :: identity

      if (len(path) > 0) identity = query(current_folder, path, merge(0_c_int, no_follow, follows))
   end function file_at

   !> Asks the operating system.
   function query(folder, path, flags) result(identity)
      integer(c_int), intent(in) :: folder, flags
      character(*), intent(in) :: path
      type(file_identity_t) :: identity
      type(statx_t) :: answer

      if (c_statx(folder, path//c_null_char, flags, basic, answer) /= 0_c_int) return
      identity%word = to_text(answer%device(1))//':'//to_text(answer%device(2))//':' &
         //to_text(answer%inode)
      identity%kind = findloc(bits_of_kinds, iand(int(answer%mode), kind_bits), dim=1)
      if (identity%kind == 0) identity%kind = kind_other
   end function query

   !> Why `path` cannot be read, in words (only regular files have an end); empty if it can.
   function file_fault(path) result(fault)
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      type(file_identity_t) :: identity

      identity = file_at(path, follows=.true.)
      fault = ''
      if (identity%kind == kind_folder) fault = 'found a folder, expected a file'
      if (identity%kind == kind_missing) fault = 'no such file'
      if (identity%kind == kind_other) fault = 'found a pipe, a device or a socket, expected a file'
   end function file_fault

   !> Whether `path` is an existing folder.
   logical function is_folder(path) result(answer)
      character(*), intent(in) :: path

      inquire (file=path//'/.', exist=answer)
   end function is_folder

   !> The folder part of a path; '.' if it has none.
   pure function folder_of(path) result(folder)
      character(*), intent(in) :: path
      character(:), allocatable :: folder
      integer :: slash

      slash = index(path, '/', back=.true.)
      folder = '.'
      if (slash == 1) folder = '/'
      if (slash > 1) folder = path(:slash - 1)
   end function folder_of

   !> Makes a folder with those above it; that it failed shows when a file is put into it.
   recursive subroutine make_folder(path)
      character(*), intent(in) :: path
      integer(c_int), parameter :: all_permissions = 511_c_int   ! 0777, less the user's mask
      integer(c_int) :: status
      integer :: last

      last = verify(path, '/', back=.true.)
      if (last == 0) return
      if (is_folder(path)) return
      call make_folder(folder_of(path(:last)))
      status = c_mkdir(path(:last)//c_null_char, all_permissions)
   end subroutine make_folder

end module disk_file
