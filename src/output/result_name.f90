!> The name of a result while a run holds it: who may write it, its files, and their end.
!>
!> NAME.part keeps other runs away and holds the time steps of a transient, NAME.tmp is the result
!> that is put together at the end, NAME.ckpt a checkpoint and NAME.ckpt.tmp the next one. An
!> interrupted or failed run leaves an older NAME as it was, and every run what is not its own.
module result_name
   use build_info, only: program_name
   use disk_file, only: file_at, file_fault, file_identity_t, folder_of, hdf5_mark, is_folder, &
      kind_link, kind_other, lock_t, place_fault, remove_file, rename_file, sync_file
   use errors, only: error_t, fail, output_error
   use file_bytes, only: seal_file
   use signals, only: clear_exit_message, set_exit_message, set_patience
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hold_name, result_name_t

   !> Endings of the files of a run until its result is complete; the checkpoint comes last.
   character(len=9), parameter, public :: working_endings(4) = [character(len=9) :: '.part', &
      '.tmp', '.ckpt.tmp', '.ckpt']

   !> A held name.
   type :: result_name_t
      !> The name.
      character(:), allocatable :: path
      !> NAME.part holds what a checkpoint needs: it stays when the run fails.
      logical :: has_checkpoint = .false.
      !> Time step of that checkpoint; without one it means nothing.
      integer :: kept_step = -1
      !> There was a NAME.part before the name was taken.
      logical :: had_part = .false.
      !> Lock on NAME.part.
      type(lock_t) :: lock
   contains
      procedure :: expect_interruption, interruption_text, give_to, remove_checkpoint, give_back, &
         remove_part, release
   end type result_name_t

contains

   !> Takes the name `path` until `release`. Error: another run has it; it cannot be a result, or
   !> would be written through a link or pipe.
   subroutine hold_name(name, path, error)
      type(result_name_t), intent(out) :: name
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      type(file_identity_t) :: file
      integer :: i

      name%path = path
      inquire (file=path//'.part', exist=name%had_part)
      fault = ''
      if (is_folder(path)) then
         fault = 'it is a folder'
      else if (.not. is_folder(folder_of(path))) then
         fault = 'there is no folder '//folder_of(path)
         if (file_fault(folder_of(path)) == '') fault = folder_of(path)//' is a file, not a folder'
      else
         do i = size(working_endings), 1, -1
            associate (working => path//trim(working_endings(i)))
               file = file_at(working, follows=.false.)
               if (file%kind == kind_link) fault = working//' is a link'
               if (file%kind == kind_other) fault = working//' is no regular file'
            end associate
         end do
      end if
      if (fault == '') then
         if (.not. name%lock%acquire(path//'.part')) fault = 'another run is writing '//path &
            //'.part'
      end if
      if (fault /= '') call fail(error, output_error, 'cannot write '//path//': '//fault)
   end subroutine hold_name

   !> What is said of a run that ends here.
   function interruption_text(self) result(text)
      class(result_name_t), intent(in) :: self
      character(:), allocatable :: text

      if (self%has_checkpoint) then
         text = 'interrupted; --resume continues after step '//to_text(self%kept_step)//' with ' &
            //self%path//'.ckpt'
      else
         text = 'interrupted without a checkpoint, nothing is kept of '//self%path
      end if
   end function interruption_text

   !> Prepares this message, and says which files are removed with it.
   subroutine expect_interruption(self, step)
      class(result_name_t), intent(inout) :: self
      integer, intent(in) :: step
      integer :: first

      self%kept_step = step
      first = merge(2, 1, self%has_checkpoint)   ! a checkpoint needs NAME.part
      call set_exit_message(program_name//': '//self%interruption_text(), &
         self%path//working_endings(first:3))
   end subroutine expect_interruption

   !> NAME.tmp becomes the result. Error: it cannot have the name, because another file has taken
   !> it, or that of NAME.part, during the run; it is NAME.new then.
   subroutine give_to(self, error)
      class(result_name_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      logical :: is_done, is_kept

      call seal_file(self%path//'.tmp', error)
      if (allocated(error)) return
      is_kept = .true.
      if (self%has_checkpoint) is_kept = sync_file(self%path//'.tmp')
      call set_patience(.true.)   ! the checkpoint goes
      fault = place_fault(self%path, hdf5_mark)
      if (.not. self%lock%holds(self%path//'.part')) fault = ': '//self%path &
         //'.part was removed or replaced while the run went on'
      is_done = is_kept .and. fault == ''
      if (is_done) is_done = rename_file(self%path//'.tmp', self%path)
      if (is_done) then
         call self%remove_checkpoint()
         return
      end if
      if (is_kept) is_kept = rename_file(self%path//'.tmp', self%path//'.new')
      if (is_kept) fault = fault//'; the result is '//self%path//'.new'
      call fail(error, output_error, 'cannot rename '//self%path//'.tmp to '//self%path//fault)
   end subroutine give_to

   !> Removes NAME.ckpt, NAME.ckpt.tmp and NAME.tmp.
   subroutine remove_checkpoint(self)
      class(result_name_t), intent(inout) :: self
      integer :: i
      logical :: is_removed

      do i = size(working_endings), 2, -1
         is_removed = remove_file(self%path//trim(working_endings(i)))
      end do
      self%has_checkpoint = .false.
   end subroutine remove_checkpoint

   !> Gives the name back; beside a complete result what a killed run left is removed.
   subroutine give_back(self, is_complete)
      class(result_name_t), intent(inout) :: self
      logical, intent(in) :: is_complete

      if (is_complete) call self%remove_checkpoint()
      if (is_complete .or. .not. self%had_part) call self%remove_part()
      call self%release()
   end subroutine give_back

   !> Removes NAME.part, unless that is another file by now.
   subroutine remove_part(self)
      class(result_name_t), intent(in) :: self
      logical :: is_removed

      if (self%lock%holds(self%path//'.part')) is_removed = remove_file(self%path//'.part')
   end subroutine remove_part

   !> Lets others write the result; from now on an end by force removes nothing.
   subroutine release(self)
      class(result_name_t), intent(inout) :: self

      call clear_exit_message()
      call self%lock%release()
   end subroutine release

end module result_name
