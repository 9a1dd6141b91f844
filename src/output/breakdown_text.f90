!> Film breakdown as people read it and as the result file keeps it.
module breakdown_text
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5_attribute, only: write_attribute
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use iteration_report, only: breakdown_t
   use kinds, only: wp
   use quantity_text, only: number_text, prefixed_text
   use result_labels, only: scaled_label
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: breakdown_sentence, write_breakdown

contains

   !> Where and when the first film below the floor was, in SI: 'film breakdown at x = -31.2 um
   !> (X = -0.2950), t = ...'.
   pure function breakdown_sentence(breakdown, film_floor, scaling) result(sentence)
      type(breakdown_t), intent(in) :: breakdown
      real(wp), intent(in) :: film_floor
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: sentence

      sentence = 'film breakdown at x = ' &
         //prefixed_text(breakdown%position*scaling%half_width, 'm')//' (X = ' &
         //number_text(breakdown%position, 4)//'), t = ' &
         //prefixed_text(breakdown%time*scaling%time, 's')//' (T = ' &
         //number_text(breakdown%time, 4)//', time step ' &
         //number_text(real(breakdown%step, wp), 9)//'): '
      if (breakdown%film > 0.0_wp) then
         sentence = sentence//'film '//prefixed_text(breakdown%film*scaling%film, 'm') &
            //', below film_floor = '//prefixed_text(film_floor*scaling%film, 'm')
      else
         sentence = sentence//'the film would close'
      end if
   end function breakdown_sentence

   !> Root attribute `film_breakdown` (0 or 1) and, if there was one, /report/film_breakdown_*.
   subroutine write_breakdown(file, breakdown, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(breakdown_t), intent(in) :: breakdown
      type(scaling_t), intent(in) :: scaling

      call write_attribute(file, '/', 'film_breakdown', merge(1, 0, breakdown%count > 0))
      if (breakdown%count == 0) return
      call write_dataset(file, '/report/film_breakdown_count', int(breakdown%count, int64), &
         new_label('solutions with a film below film_floor, or that would close', '1'))
      call write_dataset(file, '/report/film_breakdown_step', int(breakdown%step, int64), &
         new_label('time step of the first of them', '1'))
      call write_dataset(file, '/report/film_breakdown_time', breakdown%time, &
         scaled_label('time of the first of them', 'time', scaling))
      call write_dataset(file, '/report/film_breakdown_position', breakdown%position, &
         scaled_label('place of the smallest film of the first of them', 'half_width', scaling))
      call write_dataset(file, '/report/film_breakdown_film', breakdown%film, &
         scaled_label('smallest film of the first of them', 'film', scaling))
      call write_dataset(file, '/report/film_breakdown_smallest_film', breakdown%smallest_film, &
         scaled_label('smallest film of all of them', 'film', scaling))
   end subroutine write_breakdown

end module breakdown_text
