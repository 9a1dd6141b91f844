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

   !> Heights that are looked at together.
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
      character(:), allocatable :: fault
      integer(int64) :: grid(2)

      call open_source(file, dataset, source, grid, heights%spacing, error)
      if (allocated(error)) return
      if (source%nodes > huge(heights%grid)) then
         call fail(error, input_error, file//': found '//to_text(source%nodes) &
            //' nodes, expected at most '// &
            to_text(huge(heights%grid)))
         return
      end if
      fault = memory_fault('a surface', file_memory(real(source%nodes, wp)))
      if (fault /= '') then
         call fail(error, input_error, file//': '//fault)
         return
      end if
      heights%grid = int(grid)
      heights%file = file
      allocate (heights%z(source%nodes))
      call source%get(0_int64, heights%z, error)
      if (.not. allocated(error)) call look_at_heights(file, 0_int64, heights%z, error)
      if (.not. allocated(error)) call look_at_range(file, minval(heights%z), maxval(heights%z), &
         error)   ! error: handed up
   end subroutine read_heights

   !> Opens the profile in `file`, of any length, and looks through it once: `digits` is the
   !> checksum of its heights; `spacing` [m], 0: the file does not tell. Errors (input_error): as in
   !> `open_source`; gaps; an area.
   subroutine open_heights(file, dataset, source, spacing, digits, error)
      character(*), intent(in) :: file, dataset
      class(height_source_t), allocatable, intent(out) :: source
      real(wp), intent(out) :: spacing
      character(len=16), intent(out) :: digits
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: sums
      real(wp), allocatable :: z(:)
      real(wp) :: highest, lowest, spacings(2)
      integer(int64) :: first, grid(2)

      digits = ''
      spacing = 0.0_wp
      call open_source(file, dataset, source, grid, spacings, error)
      if (allocated(error)) return
      spacing = spacings(1)
      if (grid(2) > 1) then
         call fail(error, input_error, file//': found an area, expected a profile')
         return
      end if
      lowest = huge(lowest)
      highest = -huge(highest)
      allocate (z(min(block_nodes, source%nodes)))
      do first = 0, source%nodes - 1, block_nodes
         associate (piece => z(:min(block_nodes, source%nodes - first)))
            call source%get(first, piece, error)
            if (.not. allocated(error)) call look_at_heights(file, first, piece, error)
            if (allocated(error)) return
            call sums%add(piece)
            lowest = min(lowest, minval(piece))
            highest = max(highest, maxval(piece))
         end associate
      end do
      call look_at_range(file, lowest, highest, error)   ! error: handed up
      digits = sums%digits()
   end subroutine open_heights

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

   !> Error: one of the heights `z` from number `first` on (0 = the first) is none.
   subroutine look_at_heights(file, first, z, error)
      character(*), intent(in) :: file
      integer(int64), intent(in) :: first
      real(wp), intent(in) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: bad

      bad = findloc(is_height(z), .false., dim=1)
      if (bad > 0) call fail(error, input_error, file//': node '//to_text(first + bad)//': ' &
         //height_fault(z(bad)))
   end subroutine look_at_heights

   !> Error: the surface is not flat, but too low for its digits.
   subroutine look_at_range(file, lowest, highest, error)
      character(*), intent(in) :: file
      real(wp), intent(in) :: lowest, highest
      type(error_t), allocatable, intent(out) :: error

      if (range_fault(lowest, highest) /= '') call fail(error, input_error, &
         file//': '//range_fault(lowest, highest))
   end subroutine look_at_range

end module height_file
