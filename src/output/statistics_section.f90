!> /statistics of a result file: the film over the passage of rough surfaces.
module statistics_section
   use film_statistics, only: bins_per_decade, film_first, film_statistics_t, pressure_first
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: make_axis, name_axes
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: write_statistics

contains

   !> Writes /statistics, in SI; nothing if nothing was gathered. `from`: first time that counts, T.
   subroutine write_statistics(file, statistics, scaling, from)
      class(hdf5_file_t), intent(inout) :: file
      type(film_statistics_t), intent(in) :: statistics
      type(scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: from

      if (.not. allocated(statistics%thresholds)) return
      if (.not. statistics%times > 0.0_wp) return
      associate (s => statistics, film => scaling%film)
         call file%create_group('/statistics')
         call write_attribute(file, '/statistics', 'about', &
            'over the times that count, from T = statistics_from on; the contact is '// &
            'one half-width to either side of X = 0')
         call write_attribute(file, '/statistics', 'statistics_from', max(from, 0.0_wp))
         call write_dataset(file, '/statistics/film_threshold', s%thresholds*film, &
            new_label('stated films', 'm'))
         call make_axis(file, '/statistics/film_threshold')
         call write_dataset(file, '/statistics/time_below', s%times_below/s%times, &
                            new_label('share of the time in which the smallest film is below '// &
                               'each threshold', '1'))
         call write_dataset(file, '/statistics/area_below', s%shares_below/s%times, &
                            new_label('share of the contact below each threshold, mean over '// &
                               'time', '1'))
         call name_axes(file, '/statistics/time_below', '/statistics/film_threshold')
         call name_axes(file, '/statistics/area_below', '/statistics/film_threshold')
         call write_dataset(file, '/statistics/mean_film', s%film_sum/s%times*film, &
                            new_label('film, mean over the contact and time', 'm'))
         call write_dataset(file, '/statistics/smooth_film', s%smooth_film*film, &
                            new_label('film of the smooth contact at X = 0', 'm'))
         call write_dataset(file, '/statistics/rms_height', s%rms_height()*film, &
                            new_label('rms of the sum of both heights in the contact, over time', &
                               'm'))
         call write_dataset(file, '/statistics/lambda_ratio', s%lambda_ratio(), &
                            new_label('lambda ratio, smooth_film over rms_height; 0: smooth '// &
                               'surfaces', '1'))
         call write_distribution('h_min', 'smallest film, parabola through three nodes', &
            s%film_bins, film_first, film, 'm')
         call write_distribution('p_max', 'largest pressure of a node', s%pressure_bins, &
            pressure_first, &
                                 scaling%hertz_pressure, 'Pa')
      end associate

   contains

      !> The occupied stretch of a distribution: edges (n+1) and shares of the time between them
      !> (n).
      subroutine write_distribution(name, what, bins, first, scale, units)
         character(*), intent(in) :: name, what, units
         real(wp), intent(in) :: bins(:), scale
         integer, intent(in) :: first
         integer :: i, from, to

         from = findloc(bins > 0.0_wp, .true., 1)
         to = findloc(bins > 0.0_wp, .true., 1, back=.true.)
         call write_dataset(file, '/statistics/'//name//'_edges', &
                            [(scale*10.0_wp**(first + real(i - 1, wp)/bins_per_decade), i=from, &
                               to + 1)], &
                            new_label('edges of the classes of '//name//', '//what, units))
         call make_axis(file, '/statistics/'//name//'_edges')
         call write_dataset(file, '/statistics/'//name//'_class', &
            [(scale*10.0_wp**(first + (real(i, wp) - 0.5_wp)/bins_per_decade), i=from, to)], &
            new_label('middle of each class of '//name, units))
         call make_axis(file, '/statistics/'//name//'_class')
         call write_dataset(file, '/statistics/'//name//'_share', bins(from:to)/statistics%times, &
                            new_label('share of the time steps in each class of '//name, '1'))
         call name_axes(file, '/statistics/'//name//'_share', '/statistics/'//name//'_class')
      end subroutine write_distribution

   end subroutine write_statistics

end module statistics_section
