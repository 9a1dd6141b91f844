!> Real transforms of a square, in single precision, over MPI ranks: what an area shared among the
!> ranks of a cluster would spend in FFTW, the exchange between the ranks included. Beside the
!> build; bench/growth.py compiles it with mpifort and runs it.
program mpi_transforms
   use, intrinsic :: iso_c_binding
   use, intrinsic :: iso_fortran_env, only: real64
   use mpi_f08, only: MPI_Barrier, MPI_Comm_rank, MPI_Comm_size, MPI_COMM_WORLD, MPI_Finalize, &
      MPI_Init, MPI_Wtime
   implicit none (type, external)
   include 'fftw3-mpi.f03'

   integer, parameter :: pairs = 3
   integer(c_intptr_t) :: nodes, share, rows, first_row, columns, first_column
   integer :: rank, ranks, i
   real(real64) :: started, seconds
   character(len=16) :: argument
   type(c_ptr) :: forward, backward, store
   real(c_float), pointer, contiguous :: heights(:)
   complex(c_float_complex), pointer, contiguous :: waves(:)

   call MPI_Init()
   call fftwf_mpi_init()
   call MPI_Comm_rank(MPI_COMM_WORLD, rank)
   call MPI_Comm_size(MPI_COMM_WORLD, ranks)
   call get_command_argument(1, argument)
   read (argument, *) nodes

   share = fftwf_mpi_local_size_2d_transposed(nodes, nodes/2 + 1, MPI_COMM_WORLD%MPI_VAL, rows, &
      first_row, columns, first_column)
   store = fftwf_alloc_complex(int(share, c_size_t))
   call c_f_pointer(store, waves, [share])
   call c_f_pointer(store, heights, [2*share])
   ! in place, and the spectrum stays transposed: one exchange between the ranks a transform
   forward = fftwf_mpi_plan_dft_r2c_2d(nodes, nodes, heights, waves, MPI_COMM_WORLD%MPI_VAL, &
      ior(FFTW_ESTIMATE, FFTW_MPI_TRANSPOSED_OUT))
   backward = fftwf_mpi_plan_dft_c2r_2d(nodes, nodes, waves, heights, MPI_COMM_WORLD%MPI_VAL, &
      ior(FFTW_ESTIMATE, FFTW_MPI_TRANSPOSED_IN))
   heights = 1.0_c_float
   call fftwf_mpi_execute_dft_r2c(forward, heights, waves)
   call fftwf_mpi_execute_dft_c2r(backward, waves, heights)
   heights = heights/real(nodes, c_float)**2

   call MPI_Barrier(MPI_COMM_WORLD)
   started = MPI_Wtime()
   do i = 1, pairs
      call fftwf_mpi_execute_dft_r2c(forward, heights, waves)
      call fftwf_mpi_execute_dft_c2r(backward, waves, heights)
      heights = heights/real(nodes, c_float)**2
   end do
   call MPI_Barrier(MPI_COMM_WORLD)
   seconds = (MPI_Wtime() - started)/pairs
   if (abs(heights(1) - 1.0_c_float) > 1e-5_c_float) error stop 'the pair is not the identity'
   if (rank == 0) print '(i0, 1x, i0, 1x, es10.3, 1x, i0)', nodes, ranks, seconds, 8*share

   call fftwf_destroy_plan(forward)
   call fftwf_destroy_plan(backward)
   call fftwf_free(store)
   call MPI_Finalize()
end program mpi_transforms
