!> Measured heights from a file: CSV with a header line, or HDF5.
module height_file
   use, intrinsic :: iso_fortran_env, only: int64
   use case_memory, only: file_memory
   use checksum, only: checksum_t
   use csv_heights, only: csv_heights_t, open_csv_heights
   use errors, only: error_t, fail, input_error
   use hdf5_heights, only: hdf5_heights_t, open_hdf5_heights
   use height_limits, only: height_fault, is_height, range_fault
   use height_source, only: height_source_t
   use kinds, only: wp
   use life_sign, only: begin_activity
   use system_limits, only: memory_fault
   use text, only: to_lower, to_text
   implicit none (type, external)
   private

   public :: heights_t, open_heights, read_heights

   !> Heights that are read and checked together.
   integer(int64), parameter :: block_nodes = 65536_int64

   !> Heights on a uniform grid.
   type :: heights_t
      !> Heights (nx*ny) [m], x fastest.
      real(wp), allocatable :: z(:)
      !> nx, ny; ny = 1: a profile.
      integer :: grid(2) = 0
      !> Spacing of the nodes [m]; 0: the file does not tell.
      real(wp) :: spacing(2) = 0.0_wp
      !> Path of the file; not allocated: there is none.
      character(:), allocatable :: file
   end type heights_t

contains

   !> Reads all of `file`; `dataset` as in `open_source`. Errors (input_error): as there; gaps.
   subroutine read_heights(file, dataset, heights, error)
      character(*), intent(in) :: file, dataset
      type(heights_t), intent(out) :: heights
      type(error_t), allocatable, intent(out) :: error
      class(height_source_t), allocatable :: source
      character(len=16) :: digits
      character(:), allocatable :: fault
      integer(int64) :: grid(2)

      call open_source(file, dataset, source, grid, heights%spacing, error)
      if (allocated(error)) return
      fault = memory_fault('a surface', file_memory(real(source%nodes, wp)))
      if (source%nodes > huge(heights%grid)) fault = 'found '//to_text(source%nodes) &
         //' nodes, expected at most '//to_text(huge(heights%grid))
      if (fault /= '') then
         call fail(error, input_error, file//': '//fault)
         return
      end if
      heights%grid = int(grid)
      heights%file = file
      call look_through(file, source, source%nodes, heights%z, digits, error)   ! error: handed up
   end subroutine read_heights

   !> Opens the profile in `file`, of any length, and looks through it once: `digits` is the
   !> checksum of its heights; `spacing` [m], 0: the file does not tell. `z` are the heights if they
   !> fit into one block: then they need not be read again. Errors (input_error): as in
   !> `open_source`; gaps; an area.
   subroutine open_heights(file, dataset, source, spacing, z, digits, error)
      character(*), intent(in) :: file, dataset
      class(height_source_t), allocatable, intent(out) :: source
      real(wp), intent(out) :: spacing
      real(wp), allocatable, intent(out) :: z(:)
      character(len=16), intent(out) :: digits
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: spacings(2)
      integer(int64) :: grid(2)

      digits = ''
      spacing = 0.0_wp
      call open_source(file, dataset, source, grid, spacings, error)
      if (allocated(error)) return
      spacing = spacings(1)
      if (grid(2) > 1) then
         call fail(error, input_error, file//': found an area, expected a profile')
         return
      end if
      call look_through(file, source, block_nodes, z, digits, error)
      if (.not. allocated(error) .and. source%nodes > block_nodes) deallocate (z)
   end subroutine open_heights

   !> Reads all heights of `source`, `block` of them at a time; `z` are the last ones. Errors
   !> (input_error): one of them is none; the surface is not flat, but too low for its digits.
   subroutine look_through(file, source, block, z, digits, error)
      character(*), intent(in) :: file
      class(height_source_t), intent(in) :: source
      integer(int64), intent(in) :: block
      real(wp), allocatable, intent(out) :: z(:)
      character(len=16), intent(out) :: digits
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: sums
      real(wp) :: highest, lowest
      integer(int64) :: first
      integer :: bad

      lowest = huge(lowest)
      highest = -huge(highest)
      allocate (z(min(block, source%nodes)))
      do first = 0, source%nodes - 1, block
         associate (piece => z(:min(block, source%nodes - first)))
            call source%get(first, piece, error)
            if (allocated(error)) return
            bad = findloc(is_height(piece), .false., dim=1)
            if (bad > 0) then
               call fail(error, input_error, file//': node '//to_text(first + bad)//': ' &
                  //height_fault(piece(bad)))
               return
            end if
            call sums%add(piece)
            lowest = min(lowest, minval(piece))
            highest = max(highest, maxval(piece))
         end associate
      end do
      digits = sums%digits()
      if (range_fault(lowest, highest) /= '') call fail(error, input_error, &
         file//': '//range_fault(lowest, highest))
   end subroutine look_through

   !> Opens `file`; `dataset` names the column of a CSV file (empty: the second) or the path in an
   !> HDF5 file. Errors (input_error): no such file, column or dataset; positions that are no
   !> numbers or uneven; fewer than two nodes.
   subroutine open_source(file, dataset, source, grid, spacing, error)
      character(*), intent(in) :: file, dataset
      class(height_source_t), allocatable, intent(out) :: source
      integer(int64), intent(out) :: grid(2)
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      type(csv_heights_t), allocatable :: table
      type(hdf5_heights_t), allocatable :: set
      character(:), allocatable :: ending

      grid = 1
      spacing = 0.0_wp
      call begin_activity('reading '//file(index(file, '/', back=.true.) + 1:))
      ending = to_lower(file(index(file, '.', back=.true.) + 1:))
      if (ending == 'h5' .or. ending == 'hdf5') then
         allocate (set)
         call open_hdf5_heights(set, file, dataset, spacing, error)   ! error: below
         grid = set%grid
         call move_alloc(set, source)
      else
         allocate (table)
         call open_csv_heights(table, file, dataset, spacing(1), error)   ! error: below
         grid(1) = table%nodes
         call move_alloc(table, source)
      end if
      if (allocated(error)) return
      if (source%nodes < 2) call fail(error, input_error, file//': found ' &
         //to_text(source%nodes)// &
         ' nodes, expected at least 2')
   end subroutine open_source

end module height_file
