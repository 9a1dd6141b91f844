!> A synthetic profile of any length, composed of pieces that are made on demand.
!>
!> Piece k is a periodic Gaussian profile of separate random numbers; it covers half of piece k - 1
!> and half of piece k + 1. In the overlap the old one fades out as cos(a), the new one fades in as
!> sin(a): the sum of two independent Gaussian heights with these weights is Gaussian with the same
!> variance, so that the joints are invisible. The first piece follows the last. The spectrum is
!> that of a piece, blurred by about one wave in its length.
module synthetic_pieces
   use errors, only: error_t
   use kinds, only: int64, pi, wp
   use profile, only: height_source_t, smooth_ramp
   use synthetic_surface, only: bend_t, bent, find_bend, gaussian_heights, synthesis_t
   implicit none (type, external)
   private

   public :: new_synthetic_pieces, synthetic_pieces_t

   !> Made by `new_synthetic_pieces`.
   type, extends(height_source_t) :: synthetic_pieces_t
      type(synthesis_t), private :: wanted
      type(bend_t), private :: bend
      !> Spacing of the heights [m], and heights in half a piece.
      real(wp), private :: spacing = 0.0_wp
      integer, private :: half = 0
   contains
      procedure :: get
   end type synthetic_pieces_t

contains

   !> Prepares a profile of `halves` >= 2 half pieces of `half` heights, `spacing` [m] apart.
   !> Skewness and kurtosis are those of piece 0; the rms height is that of each piece. Errors
   !> (input_error): as in `synthetic_heights`.
   subroutine new_synthetic_pieces(source, wanted, spacing, half, halves, error)
      type(synthetic_pieces_t), intent(out) :: source
      type(synthesis_t), intent(in) :: wanted
      real(wp), intent(in) :: spacing
      integer, intent(in) :: half
      integer(int64), intent(in) :: halves
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: z(:)

      source%wanted = wanted
      source%spacing = spacing
      source%half = half
      source%nodes = halves*half
      call make_piece(source, 0_int64, z, error)
      if (.not. allocated(error)) call find_bend(wanted, z, source%bend, error)
   end subroutine new_synthetic_pieces

   !> Computes heights from number `first` on. Error: memory for the transforms.
   subroutine get(self, first, z, error)
      class(synthetic_pieces_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: fading(:), rising(:)
      integer(int64) :: from, k, node, to
      real(wp) :: angle
      integer :: i

      z = 0.0_wp
      do k = first/self%half, (first + size(z) - 1)/self%half
         if (allocated(rising)) then
            call move_alloc(rising, fading)
         else
            call make_piece(self, k, fading, error)
            if (allocated(error)) return
         end if
         call make_piece(self, modulo(k + 1, self%nodes/self%half), rising, error)
         if (allocated(error)) return
         from = max(first, k*self%half)
         to = min(first + size(z), (k + 1)*self%half) - 1
         do node = from, to
            i = int(node - k*self%half)
            angle = 0.5_wp*pi*smooth_ramp(real(i, wp)/self%half)
            z(node - first + 1) = cos(angle)*fading(self%half + i + 1) + sin(angle)*rising(i + 1)
         end do
      end do
      z = self%wanted%rms_height*bent(z, self%bend)
   end subroutine get

   !> Computes Gaussian heights (2*half) of piece `k`, with rms 1.
   subroutine make_piece(self, k, z, error)
      class(synthetic_pieces_t), intent(in) :: self
      integer(int64), intent(in) :: k
      real(wp), allocatable, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error

      call gaussian_heights(self%wanted, [2*self%half, 1], 2*self%half*self%spacing, &
         tiny(1.0_wp), k, z, error)
   end subroutine make_piece

end module synthetic_pieces
