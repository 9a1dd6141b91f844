!> Measured heights from a file: a table, or HDF5, which its content tells.
module height_file
   use file_bytes, only: checksum_t
   use errors, only: error_t, fail, input_error
   use hdf5_heights, only: hdf5_heights_t, open_hdf5_heights
   use hdf5_input, only: is_hdf5, place_words
   use height_form, only: height_sums_t
   use profile, only: height_source_t
   use height_table, only: conversion, height_table_t, open_table
   use measured_heights, only: are_heights, height_fault, height_range_t, height_request_t, &
      heights_t, is_height, range_fault
   use kinds, only: int64, wp
   use signals, only: begin_activity
   use system_limits, only: memory_fault
   use text, only: to_text
   implicit none (type, external)
   private

   public :: read_heights

   !> Heights that are read and checked together.
   integer(int64), parameter :: block_nodes = 65536_int64

contains

   !> Reads all heights of a file, those of an area if `is_area`, else of a profile. If their source
   !> is `kept` they may be any number, and `heights` holds them only if they fit into one block.
   !> Errors (input_error): as in `open_source`; gaps.
   subroutine read_heights(request, is_area, heights, error, kept)
      type(height_request_t), intent(in) :: request
      logical, intent(in) :: is_area
      type(heights_t), intent(out) :: heights
      type(error_t), allocatable, intent(out) :: error
      class(height_source_t), allocatable, intent(out), optional :: kept
      class(height_source_t), allocatable :: source
      character(:), allocatable :: fault
      real(wp), parameter :: of_node = 100.0_wp   ! memory [bytes]
      integer(int64) :: grid(2)

      call open_source(request, is_area, source, grid, heights%spacing, error)
      if (allocated(error)) return
      heights%file = request%file
      if (present(kept)) then
         call check_source(source, block_nodes, grid, heights, error)
         if (allocated(error)) return
         if (source%nodes > block_nodes) deallocate (heights%z)
         call move_alloc(source, kept)
         return
      end if
      fault = memory_fault('a surface', of_node*source%nodes)
      if (source%nodes > huge(heights%grid)) fault = 'found '//to_text(source%nodes) &
         //' nodes, expected at most '//to_text(huge(heights%grid))
      if (fault /= '') then
         call fail(error, input_error, request%file//': '//fault)
         return
      end if
      heights%grid = int(grid)
      call check_source(source, source%nodes, grid, heights, error)   ! error: handed up
   end subroutine read_heights

   !> Reads all heights of `source`, `block` of them at a time, for checksum and sums; `heights%z`
   !> are the last ones. Errors (input_error): they are not those of a surface.
   subroutine check_source(source, block, grid, heights, error)
      class(height_source_t), intent(in) :: source
      integer(int64), intent(in) :: block, grid(2)
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: checksum
      type(height_range_t) :: range
      character(:), allocatable :: fault
      integer(int64) :: bad, first

      heights%sums = height_sums_t(grid)
      allocate (heights%z(min(block, source%nodes)))
      bad = 0
      fault = ''
      do first = 0, source%nodes - 1, block
         associate (piece => heights%z(:min(block, source%nodes - first)))
            call source%get(first, piece, error)
            if (allocated(error)) return
            if (.not. are_heights(piece)) bad = findloc(is_height(piece), .false., 1)
            if (bad > 0) fault = height_fault(piece(bad))
            if (bad > 0) bad = first + bad
            if (bad > 0) exit
            call checksum%add(piece)
            call heights%sums%add(piece)
            call range%add(piece, first + 1)
         end associate
      end do
      heights%digits = checksum%digits()
      if (fault == '') call range%find_fault(.false., fault, bad)
      if (fault == '') fault = range_fault(heights%sums%lowest, heights%sums%highest)
      if (bad > 0) fault = 'node '//to_text(bad)//': '//fault//place_words(bad, grid)
      if (fault /= '') call fail(error, input_error, heights%file//': '//fault)
   end subroutine check_source

   !> Opens a file with an area (`is_area`) or a profile of `grid` nodes (ny = 1), `spacing` [m]
   !> apart (0: it does not say). Errors (input_error): those of tables and of HDF5; fewer than two
   !> nodes; an area for a profile, or the reverse.
   subroutine open_source(request, is_area, source, grid, spacing, error)
      type(height_request_t), intent(in) :: request
      logical, intent(in) :: is_area
      class(height_source_t), allocatable, intent(out) :: source
      integer(int64), intent(out) :: grid(2)
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      type(height_table_t), allocatable :: table
      type(hdf5_heights_t), allocatable :: set
      character(:), allocatable :: fault

      grid = 1
      spacing = 0.0_wp
      fault = ''
      call begin_activity('reading '//request%file(index(request%file, '/', back=.true.) + 1:))
      if (is_hdf5(request%file)) then
         allocate (set)
         call open_hdf5_heights(set, request, spacing, error)   ! error: below
         grid = set%grid
         call move_alloc(set, source)
      else
         allocate (table)
         call open_table(table, request, spacing(1), error)   ! error: below
         grid(1) = table%nodes
         call move_alloc(table, source)
         if (is_area) fault = conversion(request%file)
      end if
      if (allocated(error)) return
      if (source%nodes < 2) then
         fault = 'found '//to_text(source%nodes)//' nodes, expected at least 2'
      else if (is_area .and. grid(2) == 1) then
         fault = 'found a profile, expected an area'//fault
      else if (grid(2) > 1 .and. .not. is_area) then
         fault = "found an area, expected a profile: problem = 'dry_area' takes areas"
      else
         fault = ''
      end if
      if (fault /= '') call fail(error, input_error, request%file//': '//fault)
   end subroutine open_source

end module height_file
