!> Checkpoint of a transient, NAME.ckpt for NAME.part: where the run stood after a time step.
!>
!> It is written under another name, brought to the disk and renamed: the last complete one is
!> always there. It ends with a seal (module file_bytes) and holds the checksum of NAME.part: what
!> is damaged is refused before anything is read. What it holds is in module checkpoint_content.
module checkpoint
   use build_info, only: git_commit, program_name, program_version
   use checkpoint_content, only: checkpoint_t, format_number, visit_checkpoint
   use checkpoint_file, only: checkpoint_file_t
   use disk_file, only: folder_of, hdf5_mark, place_fault, remove_file, rename_file, sync_file
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: seal_fault, seal_file
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: create_hdf5_file
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   implicit none (type, external)
   private

   public :: read_checkpoint, write_checkpoint

   !> What to do about a checkpoint that cannot be used.
   character(*), parameter :: way_out = '; delete it, and the run starts at the beginning'

contains

   !> Writes a checkpoint to `path`. Error: it cannot be written; an older one is still there.
   subroutine write_checkpoint(checkpoint, path, error)
      type(checkpoint_t), intent(inout) :: checkpoint
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(checkpoint_file_t) :: file
      logical :: is_done

      call create_hdf5_file(file%file, path//'.tmp', error)
      if (allocated(error)) return
      call write_attribute(file%file, '/', 'program', program_name)
      call write_attribute(file%file, '/', 'version', program_version)
      call write_attribute(file%file, '/', 'git_commit', git_commit())
      call write_attribute(file%file, '/', 'checkpoint_format', format_number)
      call visit_checkpoint(file, checkpoint)
      call file%close(error)
      if (.not. allocated(error)) call seal_file(path//'.tmp', error)
      if (.not. allocated(error)) then
         is_done = sync_file(path//'.tmp')
         if (is_done) is_done = rename_file(path//'.tmp', path)
         if (.not. is_done) call fail(error, output_error, 'cannot write '//path &
            //place_fault(path, hdf5_mark))
         is_done = sync_file(folder_of(path))   ! not every file system can
      end if
      if (allocated(error)) is_done = remove_file(path//'.tmp')
   end subroutine write_checkpoint

   !> Reads the checkpoint `path`. Error: it is damaged, of another version or not of `case`.
   subroutine read_checkpoint(path, case, checkpoint, error)
      character(*), intent(in) :: path, case
      type(checkpoint_t), intent(out) :: checkpoint
      type(error_t), allocatable, intent(out) :: error
      type(checkpoint_file_t) :: file
      character(:), allocatable :: difference

      difference = seal_fault(path)
      if (difference /= '') then
         call fail(error, input_error, 'cannot read '//path//': '//difference//way_out)
         return
      end if
      file%is_read = .true.
      call open_hdf5_input(file%reader, path, error)
      if (allocated(error)) return
      difference = other_version(file%reader)
      if (difference == '') then
         call visit_checkpoint(file, checkpoint)
         difference = first_difference(checkpoint%case, case)
      end if
      call file%close(error)
      if (allocated(error)) return
      if (difference /= '') call fail(error, input_error, path//difference)
   end subroutine read_checkpoint

   !> What is wrong with program or version; empty: nothing.
   function other_version(reader) result(difference)
      type(hdf5_input_t), intent(inout) :: reader
      character(:), allocatable :: difference, version, commit

      difference = ''
      version = reader%text('/', 'version')
      commit = reader%text('/', 'git_commit')
      if (reader%integer_value('/', 'checkpoint_format') /= format_number .or. &
         version /= program_version .or. commit /= git_commit()) difference = &
         ' was written by another version, '//program_name//' '//version//' (commit '//commit &
         //'), this is '//program_version//' (commit '//git_commit()//')'//way_out
      if (allocated(reader%failure)) difference = ''
   end function other_version

   !> The first line in which two cases differ; empty: they are the same.
   pure function first_difference(old, new) result(difference)
      character(*), intent(in) :: old, new
      character(:), allocatable :: difference
      character(*), parameter :: ending = new_line('a')
      integer :: i, start

      difference = ''
      if (old == new .and. len(old) == len(new)) return
      associate (a => old//ending, b => new//ending)
         do i = 1, min(len(a), len(b))
            if (a(i:i) /= b(i:i)) exit
         end do
         start = index(a(:i - 1), ending, back=.true.) + 1
         difference = ' is of another case: it has '//line_at(a, start)//', the namelist ' &
            //line_at(b, start)
      end associate
   end function first_difference

   !> The line at byte `start` of a text whose lines all have an end; 'nothing' behind it.
   pure function line_at(text, start) result(line)
      character(*), intent(in) :: text
      integer, intent(in) :: start
      character(:), allocatable :: line

      line = 'nothing'
      if (start <= len(text)) line = text(start:start + index(text(start:), new_line('a')) - 2)
   end function line_at

end module checkpoint
