!> NAME.xdmf of a result NAME.h5: its fields and axes, for ParaView and other readers of XDMF.
!>
!> XML that names datasets of the result and holds no numbers itself. Each group with fields is a
!> grid of nodes: over x alone, x and y (areas), x and time or x, y and time (passages), or zeta and
!> x (layers of the film). It is made from the finished file, so that nothing is named that is not
!> there.
module xdmf_file
   use, intrinsic :: iso_fortran_env, only: int64
   use disk_file, only: any_mark, place_fault, remove_file, rename_file, xdmf_mark, xdmf_words
   use errors, only: error_t, fail, output_error
   use hdf5_input, only: hdf5_input_t, hdf5_source_t, open_hdf5_input
   use result_labels, only: field_names
   use text, only: to_text
   implicit none (type, external)
   private

   public :: write_xdmf, xdmf_path

   !> A group of a result with the axes that its fields may have, the fastest one first: where they
   !> are stored, since ParaView does not follow the links in other groups.
   type :: grid_row_t
      character(len=18) :: group
      character(len=23) :: axes(3)
   end type grid_row_t

   character(*), parameter :: x = '/solution/x', y = '/solution/y', &
      times = '/transient/profile_time'
   type(grid_row_t), parameter :: grid_rows(*) = [ &
      grid_row_t('solution', [character(len=23) :: x, y, '']), &
      grid_row_t('transient', [character(len=23) :: x, y, times]), &
      grid_row_t('momentum', [character(len=23) :: '/momentum/zeta', x, '']), &
      grid_row_t('momentum/transient', [character(len=23) :: x, times, '']), &
      grid_row_t('velocity', [character(len=23) :: '/velocity/zeta', x, ''])]

   !> Everything that can be a field.
   character(len=29), parameter :: names(*) = [character(len=29) :: field_names(2:), 'gap', &
      'height_undeformed', 'height_loaded', 'height_unloaded', 'plastic_deformation', &
      'film_breakdown', 'u', 'w', 'layer_pressure', 'shear_stress']

   character(*), parameter :: nl = new_line('a')
   !> The axis of a direction without nodes.
   character(*), parameter :: zero = '<DataItem Dimensions="1" NumberType="Float" '// &
      'Precision="8" Format="XML">0</DataItem>'//nl

contains

   !> Name of the file of the result `path`.
   pure function xdmf_path(path)
      character(*), intent(in) :: path
      character(:), allocatable :: xdmf_path
      integer :: last

      last = len(path)
      if (last > 3) then
         if (path(last - 2:) == '.h5') last = last - 3
      end if
      xdmf_path = path(:last)//'.xdmf'
   end function xdmf_path

   !> Writes the file of the result `path`. Error (output_error): one cannot be read or written.
   subroutine write_xdmf(path, error)
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      type(error_t), allocatable :: failure
      character(:), allocatable :: name, text
      character(len=5), parameter :: entities(3) = [character(len=5) :: '&amp;', '&lt;', '&gt;']
      integer :: i, k

      name = ''   ! as XML has it
      do i = index(path, '/', back=.true.) + 1, len(path)
         k = index('&<>', path(i:i))
         if (k > 0) name = name//trim(entities(k))
         if (k == 0) name = name//path(i:i)
      end do
      text = '<?xml version="1.0" encoding="UTF-8"?>'//nl//xdmf_words//' -->'//nl &
         //'<Xdmf Version="2.0">'//nl//'<Domain>'//nl
      call open_hdf5_input(reader, path, failure)   ! error: the reader keeps it
      do i = 1, size(grid_rows)
         call add_grid(reader, grid_rows(i), name, text)
      end do
      call reader%close(failure)
      if (allocated(failure)) then
         text = xdmf_path(path)//' cannot be written: '//failure%message
      else
         text = fault_of_writing(xdmf_path(path), text//'</Domain>'//nl//'</Xdmf>'//nl)
      end if
      if (text /= '') call fail(error, output_error, text)
   end subroutine write_xdmf

   !> Adds the grid of a group, if the result has it.
   subroutine add_grid(reader, row, file, text)
      type(hdf5_input_t), intent(inout) :: reader
      type(grid_row_t), intent(in) :: row
      character(*), intent(in) :: file
      character(:), allocatable, intent(inout) :: text
      character(:), allocatable :: fields, group
      character(len=len(row%axes)) :: axes(3)
      type(hdf5_source_t) :: source
      integer(int64) :: nodes(3)
      integer :: i, rank

      group = '/'//trim(row%group)//'/'
      nodes = 1
      rank = 0
      do i = 1, size(row%axes)
         if (row%axes(i) == '') cycle
         if (.not. reader%has(trim(row%axes(i)))) cycle
         rank = rank + 1
         axes(rank) = row%axes(i)
         source = reader%content_of(trim(axes(rank)), are_numbers=.false.)
         nodes(rank:rank) = source%extents
      end do
      fields = ''
      do i = 1, size(names)
         if (.not. reader%has(group//trim(names(i)))) cycle
         source = reader%content_of(group//trim(names(i)), are_numbers=.false.)
         if (size(source%extents) /= rank) cycle
         if (any(source%extents /= nodes(:rank))) cycle
         ! ParaView reads as many numbers as the extents say for the dimensions that the grid has
         fields = fields//'<Attribute Name="'//trim(names(i)) &
            //'" AttributeType="Scalar" Center="Node">'//nl//item(group//trim(names(i)), nodes) &
            //'</Attribute>'//nl
      end do
      if (fields == '') return
      text = text//'<Grid Name="'//trim(row%group)//'" GridType="Uniform">'//nl// &
         '<Topology TopologyType="3DRectMesh" Dimensions="'//to_text(nodes(3))//' ' &
         //to_text(nodes(2))//' '//to_text(nodes(1))//'"/>'//nl &
         //'<Geometry GeometryType="VXVYVZ">'//nl
      do i = 1, size(nodes)
         if (i > rank) then
            text = text//zero
         else
            text = text//item(trim(axes(i)), nodes(i:i))
         end if
      end do
      text = text//'</Geometry>'//nl//fields//'</Grid>'//nl

   contains

      !> The element that names a dataset; its extents are given the fastest first.
      function item(path, extents)
         character(*), intent(in) :: path
         integer(int64), intent(in) :: extents(:)
         character(:), allocatable :: item
         integer :: k

         source = reader%content_of(path, are_numbers=.false.)
         item = ''
         do k = 1, size(extents)
            item = ' '//to_text(extents(k))//item
         end do
         item = '<DataItem Dimensions="'//item(2:)//'" NumberType="Float" Precision="' &
            //to_text(int(source%bytes, int64))//'" Format="HDF">'//file//':'//path//'</DataItem>' &
            //nl
      end function item

   end subroutine add_grid

   !> Writes `text` to `path`, whole or not at all: what stands against it, or nothing.
   function fault_of_writing(path, text) result(fault)
      character(*), intent(in) :: path, text
      character(:), allocatable :: fault
      character(len=256) :: message
      integer :: status, unit
      logical :: is_done

      fault = place_fault(path//'.part', any_mark)
      if (fault /= '') fault = 'cannot write '//path//'.part'//fault
      if (fault /= '') return
      open (newunit=unit, file=path//'.part', access='stream', form='unformatted', &
         action='write', status='replace', iostat=status, iomsg=message)
      if (status == 0) write (unit, iostat=status, iomsg=message) text
      if (status == 0) close (unit, iostat=status, iomsg=message)
      if (status /= 0) then
         fault = 'cannot write '//path//': '//trim(message)
      else if (.not. rename_file(path//'.part', path)) then
         fault = 'cannot rename '//path//'.part to '//path//place_fault(path, xdmf_mark)
      end if
      if (fault /= '') is_done = remove_file(path//'.part')
   end function fault_of_writing

end module xdmf_file
