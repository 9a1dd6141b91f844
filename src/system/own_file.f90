!> Which files this program may replace or remove: those that it has written, and no others. They
!> are known by a mark in their bytes, so that a damaged or half-written file is known too. A signal
!> handler may ask as well: nothing is allocated in `mark_of`.
module own_file
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_loc, c_null_char, c_size_t
   use build_info, only: program_name
   use file_identity, only: file_identity_t, kind_regular, look_at_file
   use signal_calls, only: c_close, c_open, c_pread, c_seek
   implicit none (type, external)
   private

   public :: mark_of, place_fault

   !> What a file is marked as: not at all; an HDF5 file; an XDMF file; nothing is in it yet, which
   !> a run that was killed may leave. `any_mark`: one of the last three.
   integer, parameter, public :: no_mark = 0, hdf5_mark = 1, xdmf_mark = 2, any_mark = 3
   integer, parameter :: empty_mark = 4
   !> The marks: the attribute `program` as HDF5 files have it, and the place where it is written
   !> before the library writes anything [bytes]; the first words of a seal; those of an XDMF file.
   character(len=*), parameter :: attribute = 'program'//c_null_char
   character(len=*), parameter, public :: early_words = attribute//repeat(c_null_char, &
      16)//program_name
   integer(c_int64_t), parameter, public :: early_place = 840_c_int64_t
   character(len=*), parameter, public :: seal_words = program_name//' checksum ', &
      xdmf_words = '<!-- made by '//program_name
   !> From the name of the attribute to the end of its value, at most; an HDF5 file (superblock of
   !> version 0) that holds nothing; a seal [bytes].
   integer, parameter :: attribute_bytes = 64, empty_bytes = 800
   character(len=*), parameter :: signature = char(137)//'HDF'//achar(13)//achar(10)//achar(26) &
      //achar(10)//c_null_char
   integer, parameter, public :: seal_bytes = 80
   !> Bytes that are looked at.
   integer, parameter :: head_bytes = 4096
   !> O_RDONLY + O_NONBLOCK, so that a pipe does not wait for a writer; SEEK_END.
   integer(c_int), parameter :: look_only = 2048_c_int, from_end = 2_c_int

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
      file = look_at_file(path, follows=.true.)
      if (file%kind /= kind_regular) return
      found = mark_of(path//c_null_char)
      if (found == mark .or. (mark == any_mark .and. found /= no_mark)) return
      fault = ': it is there, and '//program_name//' has not written it'
   end function place_fault

   !> The mark of the file `path`, which has a zero at its end.
   recursive function mark_of(path) result(mark)
      character(kind=c_char), intent(in) :: path(*)
      integer :: mark
      character(kind=c_char, len=head_bytes), target :: head
      integer(c_int64_t) :: bytes
      integer(c_int) :: descriptor, status
      integer :: length, place

      mark = no_mark
      descriptor = c_open(path, look_only)
      if (descriptor < 0_c_int) return
      bytes = c_seek(descriptor, 0_c_int64_t, from_end)
      length = int(c_pread(descriptor, c_loc(head), int(head_bytes, c_size_t), 0_c_int64_t))
      place = index(head(:length), attribute)
      if (place > 0) then
         if (index(head(place:min(place + attribute_bytes, length)), program_name) > 0) mark = &
            hdf5_mark
      end if
      if (index(head(:length), xdmf_words) > 0) mark = xdmf_mark
      if (bytes == 0_c_int64_t .or. (bytes <= empty_bytes .and. index(head(:length), signature) &
         == 1)) mark = empty_mark
      if (mark == no_mark .and. bytes > seal_bytes) then
         length = int(c_pread(descriptor, c_loc(head), int(seal_bytes, c_size_t), &
            bytes - seal_bytes))
         if (index(head(:length), seal_words) == 1) mark = hdf5_mark
      end if
      status = c_close(descriptor)
   end function mark_of

end module own_file
