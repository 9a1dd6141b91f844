!> Which file a path leads to (Linux: statx(2), whose answer looks the same on every processor): two
!> paths name the same file if device and inode agree, whatever links and folders lie between.
module file_identity
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_int32_t, c_int64_t, &
      c_null_char
   implicit none (type, external)
   private

   public :: file_fault, file_identity_t, identity_text, is_same_file, look_at_file, &
      look_at_open_file

   !> What a path leads to; `kind_other`: a pipe, a device, a socket.
   integer, parameter, public :: kind_missing = 0, kind_regular = 1, kind_link = 3, kind_other = 4
   integer, parameter :: kind_folder = 2

   !> A file as the operating system knows it.
   type :: file_identity_t
      integer :: kind = kind_missing
      integer(c_int32_t), private :: device(2) = 0_c_int32_t
      integer(c_int64_t), private :: inode = 0_c_int64_t
   end type file_identity_t

   !> struct statx: links, owner and times of the file are not looked at.
   type, bind(c) :: statx_t
      integer(c_int32_t) :: mask, block_size
      integer(c_int64_t) :: attributes
      integer(c_int32_t) :: links, user, group
      integer(c_int16_t) :: mode, spare
      integer(c_int64_t) :: inode, bytes, blocks, attributes_mask, times(8)
      integer(c_int32_t) :: own_device(2), device(2)
      integer(c_int64_t) :: reserved(14)
   end type statx_t

   !> AT_FDCWD, AT_SYMLINK_NOFOLLOW, AT_EMPTY_PATH, STATX_BASIC_STATS.
   integer(c_int), parameter :: current_folder = -100_c_int, no_follow = 256_c_int, &
      empty_path = 4096_c_int, basic = 2047_c_int
   !> The part of the mode that is the kind of file (S_IFMT), and its values.
   integer, parameter :: kind_bits = 61440, bits_folder = 16384, bits_regular = 32768, &
      bits_link = 40960

   interface
      !> statx(2).
      function c_statx(folder, path, flags, mask, answer) bind(c, name='statx') result(status)
         import :: c_char, c_int, statx_t
         implicit none (type, external)
         integer(c_int), value :: folder
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags, mask
         type(statx_t), intent(inout) :: answer
         integer(c_int) :: status
      end function c_statx
   end interface

contains

   !> What `path` leads to, or with `follows` false a link itself. What cannot be looked at counts
   !> as missing.
   function look_at_file(path, follows) result(identity)
      character(*), intent(in) :: path
      logical, intent(in) :: follows
      type(file_identity_t) :: identity

      if (len(path) > 0) identity = look(current_folder, path, merge(0_c_int, no_follow, follows))
   end function look_at_file

   !> The file of an open descriptor.
   function look_at_open_file(descriptor) result(identity)
      integer(c_int), intent(in) :: descriptor
      type(file_identity_t) :: identity

      identity = look(descriptor, '', empty_path)
   end function look_at_open_file

   !> Why `path` cannot be read, in words (only regular files have an end); empty if it can.
   function file_fault(path) result(fault)
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      type(file_identity_t) :: identity

      identity = look_at_file(path, follows=.true.)
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

   !> Asks the operating system.
   function look(folder, path, flags) result(identity)
      integer(c_int), intent(in) :: folder, flags
      character(*), intent(in) :: path
      type(file_identity_t) :: identity
      type(statx_t) :: answer

      if (c_statx(folder, path//c_null_char, flags, basic, answer) /= 0_c_int) return
      identity%device = answer%device
      identity%inode = answer%inode
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
   end function look

   !> Whether both are there, and the same.
   elemental function is_same_file(one, other) result(is_same)
      type(file_identity_t), intent(in) :: one, other
      logical :: is_same

      is_same = one%kind /= kind_missing .and. other%kind /= kind_missing
      is_same = is_same .and. one%inode == other%inode .and. all(one%device == other%device)
   end function is_same_file

   !> Device and inode as a word.
   pure function identity_text(identity) result(word)
      type(file_identity_t), intent(in) :: identity
      character(len=64) :: word

      write (word, '(2(i0, a), i0)') identity%device(1), ':', identity%device(2), ':', &
         identity%inode
   end function identity_text

end module file_identity
