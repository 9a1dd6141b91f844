!> Name and version of this program, and the commit it was built from.
module build_info
   implicit none (type, external)
   private

   public :: git_commit

   !> Name of the program.
   character(*), parameter, public :: program_name = 'asperity'
   !> Version of the program; a test keeps it equal to the one in fpm.toml and CITATION.cff.
   character(*), parameter, public :: program_version = '0.2.0'

contains

   !> The commit of this build, with `-dirty` if files had changed since; 'unknown' without git.
   !>
   !> The included line is `include/git_commit.inc`, in which `git archive` writes the commit of a
   !> tarball, or the one that `make` writes to build/info/, which is found first.
   pure function git_commit() result(commit)
      character(:), allocatable :: commit

      ! make writes this line; a generated module would stop a plain `fpm build`.
      ! allow(include-statement)
      include 'git_commit.inc'
      if (commit(1:1) == '$') commit = 'unknown'
   end function git_commit

end module build_info
