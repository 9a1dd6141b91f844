!> Routines of the running program and its libraries by name: those that not every machine has.
module program_symbol
   use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_null_char, c_null_ptr, c_ptr
   implicit none (type, external)
   private

   public :: address_of

   interface
      !> C library: address of a symbol of the running program, null if there is none.
      function dlsym(handle, symbol) bind(c, name='dlsym') result(address)
         import :: c_char, c_funptr, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
         type(c_funptr) :: address
      end function dlsym
   end interface

contains

   !> The address of the routine `name`; null: there is none.
   function address_of(name) result(address)
      character(*), intent(in) :: name
      type(c_funptr) :: address

      address = dlsym(c_null_ptr, name//c_null_char)
   end function address_of

end module program_symbol
