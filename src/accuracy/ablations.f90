!> The ingredients of a lubricated contact that could be left out, and the contact without one of
!> them: what a leaner model would have been.
module ablations
   use features, only: rough_surface_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, rough_contact_t, smoothen
   use lubricant, only: density_constant, eased_fluid, thins, viscosity_barus, viscosity_constant, &
      viscosity_roelands
   use text, only: to_text
   implicit none (type, external)
   private

   public :: has_roughness, ingredient_t, ingredients_of, is_of_oil, is_of_surfaces, leave_out

   !> Rows of the table, first those cheap to measure or most often important; and each of several
   !> features of a surface.
   integer, parameter, public :: roughness = 1, shear_thinning = 6, compressibility = 7, &
      roelands_law = 8, piezoviscosity = 9, elasticity = 10, squeeze = 11, roughness_1 = 12, &
      roughness_2 = 13, one_feature = 14
   integer, parameter :: contact_of_asperities = 2, starvation = 3, heat = 4, heat_of_inlet = 5

   !> What can be left out.
   type :: ingredient_t
      !> Row of the table; 0: a numerical choice.
      integer :: kind
      !> Name in the result, and what replaces it.
      character(len=20) :: name
      character(len=64) :: text
      !> Whether a quarter of it can be left out if there is no solution without all of it.
      logical :: can_reduce = .false.
      !> Surface and number of a feature.
      integer :: surface = 0, feature = 0
   end type ingredient_t

   type(ingredient_t), parameter, public :: ingredients(*) = [ &
      ingredient_t(roughness, 'roughness', 'smooth surfaces'), &
      ingredient_t(contact_of_asperities, 'asperities', 'a film without asperities'), &
      ingredient_t(starvation, 'supply', 'a flooded inlet'), &
      ingredient_t(heat, 'heat', 'oil as warm as in the inlet'), &
      ingredient_t(heat_of_inlet, 'inlet_heating', 'oil that sliding alone warms'), &
      ingredient_t(shear_thinning, 'shear_thinning', 'Newtonian oil', .true.), &
      ingredient_t(compressibility, 'compressibility', 'constant density'), &
      ingredient_t(roelands_law, 'roelands', 'viscosity by Barus', .true.), &
      ingredient_t(piezoviscosity, 'piezoviscosity', 'constant viscosity', .true.), &
      ingredient_t(elasticity, 'elasticity', 'rigid bodies', .true.), &
      ingredient_t(squeeze, 'squeeze', 'a steady solution at each time'), &
      ingredient_t(roughness_1, 'roughness_1', 'surface 1 smooth'), &
      ingredient_t(roughness_2, 'roughness_2', 'surface 2 smooth')]

contains

   !> Ingredients of a contact. A steady contact has no squeeze term; a point contact without
   !> elasticity has no solver.
   pure function ingredients_of(contact, is_transient) result(list)
      class(rough_contact_t), intent(in) :: contact
      logical, intent(in) :: is_transient
      type(ingredient_t), allocatable :: list(:)
      logical :: is_rough(2), is_there(size(ingredients))

      is_rough = [has_roughness(contact%surface_1), has_roughness(contact%surface_2)]
      is_there = .false.
      is_there(roughness) = any(is_rough)
      is_there(squeeze) = is_transient .and. any(is_rough)
      is_there([roughness_1, roughness_2]) = all(is_rough)
      associate (fluid => contact%fluid)
         is_there(shear_thinning) = thins(fluid)
         is_there(compressibility) = fluid%density_law /= density_constant
         is_there(roelands_law) = fluid%viscosity_law == viscosity_roelands
         is_there(piezoviscosity) = fluid%viscosity_law /= viscosity_constant .and. &
            fluid%alpha_bar > 0.0_wp
      end associate
      select type (contact)
      type is (line_contact_t)
         is_there(contact_of_asperities) = allocated(contact%asperities)
         is_there(starvation) = contact%supply < huge(1.0_wp)
         is_there(heat) = allocated(contact%heating)
         if (allocated(contact%heating)) is_there(heat_of_inlet) = contact%heating%has_flow
         is_there(elasticity) = contact%elasticity > 0.0_wp
      end select
      list = [pack(ingredients, is_there), features_of(contact%surface_1, 1), &
         features_of(contact%surface_2, 2)]
   end function ingredients_of

   !> The features of a surface with several.
   pure function features_of(surface, number) result(list)
      type(rough_surface_t), intent(in) :: surface
      integer, intent(in) :: number
      type(ingredient_t), allocatable :: list(:)
      integer :: i

      allocate (list(0))
      if (.not. allocated(surface%features)) return
      if (size(surface%features) < 2) return
      do i = 1, size(surface%features)
         list = [list, ingredient_t(one_feature, 'feature_'//to_text(number)//'_'//to_text(i), &
            'surface '//to_text(number)//' without its feature '//to_text(i), .false., number, i)]
      end do
   end function features_of

   !> Whether a surface has features or a profile.
   pure logical function has_roughness(surface)
      type(rough_surface_t), intent(in) :: surface

      has_roughness = allocated(surface%profile)
      if (allocated(surface%features)) has_roughness = has_roughness .or. size(surface%features) > 0
   end function has_roughness

   !> Whether a kind of ingredients belongs to the surfaces or their motion: a smooth contact says
   !> nothing about it.
   pure elemental logical function is_of_surfaces(kind)
      integer, intent(in) :: kind

      is_of_surfaces = kind == roughness .or. kind >= squeeze
   end function is_of_surfaces

   !> Whether the contact without an ingredient is the same but for its oil.
   pure logical function is_of_oil(ingredient)
      type(ingredient_t), intent(in) :: ingredient

      is_of_oil = ingredient%kind >= shear_thinning .and. ingredient%kind <= piezoviscosity
   end function is_of_oil

   !> Removes an ingredient from a contact, or all but a fraction `rest` of it (> 0 only if it can
   !> be reduced): ln mu times `rest`; Roelands' z moved towards 1; Eyring stress or stiffness
   !> divided by `rest`.
   pure subroutine leave_out(contact, ingredient, rest)
      class(rough_contact_t), intent(inout) :: contact
      type(ingredient_t), intent(in) :: ingredient
      real(wp), intent(in) :: rest

      associate (fluid => contact%fluid)
         select case (ingredient%kind)
         case (compressibility)
            fluid%density_law = density_constant
         case (piezoviscosity)
            contact%moes_l_sum = rest*contact%moes_l_sum
            fluid%alpha_bar = rest*fluid%alpha_bar
            if (.not. rest > 0.0_wp) fluid%viscosity_law = viscosity_constant
         case (roelands_law)
            fluid%z = 1 - rest*(1 - fluid%z)
            if (.not. rest > 0.0_wp) fluid%viscosity_law = viscosity_barus
         case (shear_thinning)
            if (rest > 0.0_wp) then
               fluid = eased_fluid(fluid, 1/rest)
            else
               if (allocated(fluid%rheology)) deallocate (fluid%rheology)
            end if
         case (roughness, roughness_1, roughness_2)
            if (ingredient%kind /= roughness_2) call smoothen(contact%surface_1)
            if (ingredient%kind /= roughness_1) call smoothen(contact%surface_2)
         case (one_feature)
            if (ingredient%surface == 1) call remove(contact%surface_1, ingredient%feature)
            if (ingredient%surface == 2) call remove(contact%surface_2, ingredient%feature)
         case (contact_of_asperities:heat_of_inlet, elasticity, squeeze)
            continue   ! those of lines: below; the same contact, solved in another way
         case default
            error stop 'leave_out: an ingredient without its case'
         end select
      end associate
      select type (contact)
      type is (line_contact_t)   ! points have none of these
         select case (ingredient%kind)
         case (elasticity)
            contact%elasticity = rest*contact%elasticity
         case (contact_of_asperities)
            if (allocated(contact%asperities)) deallocate (contact%asperities)
         case (starvation)
            contact%supply = huge(1.0_wp)
         case (heat)
            if (allocated(contact%heating)) deallocate (contact%heating)
         case (heat_of_inlet)
            if (allocated(contact%heating)) contact%heating%has_flow = .false.
         case default   ! above
            continue
         end select
      end select
   end subroutine leave_out

   !> Removes one feature from a surface.
   pure subroutine remove(surface, feature)
      type(rough_surface_t), intent(inout) :: surface
      integer, intent(in) :: feature

      surface%features = [surface%features(:feature - 1), surface%features(feature + 1:)]
   end subroutine remove

end module ablations
