!> Measured heights from a file: a CSV table, or HDF5.
module height_file
   use, intrinsic :: iso_fortran_env, only: int64
   use case_memory, only: area_memory, file_memory
   use checksum, only: checksum_t
   use csv_heights, only: csv_heights_t, open_csv_heights
   use errors, only: error_t, fail, input_error
   use hdf5_heights, only: hdf5_heights_t, open_hdf5_heights
   use height_form, only: new_sums
   use height_limits, only: first_fault, height_fault, range_fault
   use height_source, only: height_source_t
   use measured_heights, only: heights_t
   use kinds, only: wp
   use length_units, only: height_units_t
   use large_pages, only: prefer_large_pages
   use life_sign, only: begin_activity
   use system_limits, only: memory_fault
   use text, only: to_lower, to_text
   implicit none (type, external)
   private

   public :: open_heights, read_heights

   !> Heights that are read and checked together.
   integer(int64), parameter :: block_nodes = 65536_int64

contains

   !> Reads all of `file`; `dataset` and `units` as in `open_source`. Errors (input_error): as
   !> there; gaps.
   subroutine read_heights(file, dataset, units, heights, error)
      character(*), intent(in) :: file, dataset
      type(height_units_t), intent(in) :: units
      type(heights_t), intent(out) :: heights
      type(error_t), allocatable, intent(out) :: error
      class(height_source_t), allocatable :: source
      character(:), allocatable :: fault
      integer(int64) :: grid(2)

      call open_source(file, dataset, units, source, grid, heights%spacing, error)
      if (allocated(error)) return
      fault = memory_fault('a surface', file_memory(real(source%nodes, wp)))
      if (source%nodes > huge(heights%grid)) fault = 'found '//to_text(source%nodes) &
         //' nodes, expected at most '//to_text(huge(heights%grid))
      if (fault /= '') then
         call fail(error, input_error, file//': '//fault)
         return
      end if
      if (grid(2) > 1) call prefer_large_pages(area_memory(source%nodes))
      heights%grid = int(grid)
      heights%file = file
      call look_through(source, source%nodes, grid, heights, error)   ! error: handed up
   end subroutine read_heights

   !> Opens the profile in `file`, of any length, and looks through it once; `heights` has its
   !> heights if they fit into one block: then they need not be read again. Errors (input_error): as
   !> in `open_source`; gaps; an area.
   subroutine open_heights(file, dataset, units, source, heights, error)
      character(*), intent(in) :: file, dataset
      type(height_units_t), intent(in) :: units
      class(height_source_t), allocatable, intent(out) :: source
      type(heights_t), intent(out) :: heights
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: grid(2)

      call open_source(file, dataset, units, source, grid, heights%spacing, error)
      if (allocated(error)) return
      if (grid(2) > 1) then
         call fail(error, input_error, file//': found an area, expected a profile')
         return
      end if
      heights%file = file
      call look_through(source, block_nodes, grid, heights, error)
      if (.not. allocated(error) .and. source%nodes > block_nodes) deallocate (heights%z)
   end subroutine open_heights

   !> Reads all heights of `source`, `block` of them at a time, for checksum and sums; `heights%z`
   !> are the last ones. Errors (input_error): one of them is none; the surface is not flat, but too
   !> low for its digits.
   subroutine look_through(source, block, grid, heights, error)
      class(height_source_t), intent(in) :: source
      integer(int64), intent(in) :: block, grid(2)
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: checksum
      integer(int64) :: first
      integer :: bad

      heights%sums = new_sums(grid)
      allocate (heights%z(min(block, source%nodes)))
      do first = 0, source%nodes - 1, block
         associate (piece => heights%z(:min(block, source%nodes - first)))
            call source%get(first, piece, error)
            if (allocated(error)) return
            bad = first_fault(piece)
            if (bad > 0) then
               call fail(error, input_error, heights%file//': node '//to_text(first + bad)//': ' &
                  //height_fault(piece(bad)))
               return
            end if
            call checksum%add(piece)
            call heights%sums%add(piece)
         end associate
      end do
      heights%digits = checksum%digits()
      associate (lowest => heights%sums%lowest, highest => heights%sums%highest)
         if (range_fault(lowest, highest) /= '') call fail(error, input_error, &
            heights%file//': '//range_fault(lowest, highest))
      end associate
   end subroutine look_through

   !> Opens `file`; `dataset` names the column of a CSV file (empty: the second) or the path in an
   !> HDF5 file, `units` are those of the keys. Errors (input_error): no such file, column or
   !> dataset; positions that are no numbers or uneven; fewer than two nodes.
   subroutine open_source(file, dataset, units, source, grid, spacing, error)
      character(*), intent(in) :: file, dataset
      type(height_units_t), intent(in) :: units
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
         call open_hdf5_heights(set, file, dataset, units, spacing, error)   ! error: below
         grid = set%grid
         call move_alloc(set, source)
      else
         allocate (table)
         call open_csv_heights(table, file, dataset, units, spacing(1), error)   ! error: below
         grid(1) = table%nodes
         call move_alloc(table, source)
      end if
      if (allocated(error)) return
      if (source%nodes < 2) call fail(error, input_error, file//': found ' &
         //to_text(source%nodes)// &
         ' nodes, expected at least 2')
   end subroutine open_source

end module height_file
