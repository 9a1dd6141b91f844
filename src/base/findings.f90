!> Findings about an input file, collected for one report.
module findings
   use text, only: quoted, to_text
   implicit none (type, external)
   private

   public :: findings_t

   !> One finding: the line of the file (below 0: of an entry of the command line there, 0: none)
   !> and what is found and expected.
   type :: finding_t
      integer :: line = 0
      character(:), allocatable :: message
   end type finding_t

   !> A growing list of findings; empty means that the input is good.
   type :: findings_t
      private
      type(finding_t), allocatable :: items(:)
      integer, public :: count = 0
   contains
      procedure, public :: add => add_finding
      procedure, public :: report => findings_report
   end type findings_t

   !> Most findings shown in one report; a broken file may have many more.
   integer, parameter :: max_shown = 50
   !> Most findings kept; later ones are only counted.
   integer, parameter :: max_kept = 1000

contains

   !> Appends a finding: `line` as above, group and key (either may be empty), message.
   subroutine add_finding(self, line, group, key, message)
      class(findings_t), intent(inout) :: self
      integer, intent(in) :: line
      character(*), intent(in) :: group, key, message
      character(:), allocatable :: place

      if (.not. allocated(self%items)) allocate (self%items(max_kept))
      self%count = self%count + 1
      if (self%count > max_kept) return
      place = ''
      if (len_trim(group) > 0) place = '&' // quoted(group)
      if (len_trim(key) > 0) place = place // ' ' // quoted(key)
      if (len(place) > 0) place = place // ': '
      self%items(self%count) = finding_t(line, place // message)
   end subroutine add_finding

   !> All findings in the order of their lines, one a line: `file:line: &group key: found ...,
   !> expected ... [unit]`; for an entry of the command line `file: --set: ...`.
   function findings_report(self, file) result(report)
      class(findings_t), intent(in) :: self
      character(*), intent(in) :: file
      character(:), allocatable :: report
      logical, allocatable :: is_left(:)
      integer :: i, k

      allocate (is_left(min(self%count, max_kept)), source=.true.)
      report = ''
      do i = 1, min(self%count, max_shown)
         k = minloc(abs(self%items(:size(is_left))%line), 1, is_left)   ! of equal ones the first
         is_left(k) = .false.
         if (i > 1) report = report // new_line('a')
         report = report // file // ':'
         associate (finding => self%items(k))
            if (finding%line > 0) report = report // to_text(finding%line) // ':'
            if (finding%line < 0) report = report // ' --set:'
            report = report // ' ' // finding%message
         end associate
      end do
      if (self%count > max_shown) report = report // new_line('a') // file // ': ... and ' &
         // to_text(self%count - max_shown) // ' more findings'
   end function findings_report

end module findings
