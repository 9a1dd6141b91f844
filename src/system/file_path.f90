!> What a path leads to, and its folder. Two paths name the same file if device and inode agree,
!> whatever links and folders lie between.
module file_path
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char
   use c_library, only: c_mkdir, c_statx, statx_t
   implicit none (type, external)
   private

   public :: file_fault, folder_of, is_folder, file_at, file_of_descriptor, make_folder

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
   !> The part of the mode that is the kind of file (S_IFMT), and its values.
   integer, parameter :: kind_bits = 61440, bits_folder = 16384, bits_regular = 32768, &
      bits_link = 40960

contains

   !> What `path` leads to, or with `follows` false a link itself.
   function file_at(path, follows) result(identity)
      character(*), intent(in) :: path
      logical, intent(in) :: follows
      type(file_identity_t) :: identity

      if (len(path) > 0) identity = query(current_folder, path, merge(0_c_int, no_follow, follows))
   end function file_at

   !> The file of an open descriptor.
   function file_of_descriptor(descriptor) result(identity)
      integer(c_int), intent(in) :: descriptor
      type(file_identity_t) :: identity

      identity = query(descriptor, '', empty_path)
   end function file_of_descriptor

   !> Asks the operating system.
   function query(folder, path, flags) result(identity)
      integer(c_int), intent(in) :: folder, flags
      character(*), intent(in) :: path
      type(file_identity_t) :: identity
      type(statx_t) :: answer

      if (c_statx(folder, path//c_null_char, flags, basic, answer) /= 0_c_int) return
      write (identity%word, '(2(i0, a), i0)') answer%device(1), ':', answer%device(2), ':', &
         answer%inode
      select case (iand(int(answer%mode), kind_bits))
      case (bits_regular)
         identity%kind = kind_regular
      case (bits_folder)
         identity%kind = kind_folder
      case (bits_link)
         identity%kind = kind_link
      case default   ! all others
         identity%kind = kind_other
      end select
   end function query

   !> Why `path` cannot be read, in words (only regular files have an end); empty if it can.
   function file_fault(path) result(fault)
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      type(file_identity_t) :: identity

      identity = file_at(path, follows=.true.)
      select case (identity%kind)
      case (kind_regular)
         fault = ''
      case (kind_folder)
         fault = 'found a folder, expected a file'
      case (kind_missing)
         fault = 'no such file'
      case default   ! all others
         fault = 'found a pipe, a device or a socket, expected a file'
      end select
   end function file_fault

   !> Whether `path` is an existing folder.
   function is_folder(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer

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

   !> Makes a folder with those above it, if they are not there; no name: nothing. Whether that was
   !> done shows when a file is put into it.
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

end module file_path
