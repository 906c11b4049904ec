-- @NAME@_device: the device in VHDL, to be filled in. Until then every output is zero.
--
-- Inputs are taken where in_valid and in_ready are high at a rising edge, outputs where out_valid and out_ready are: one output
-- an input, in the same order, after any number of cycles. rst is high for the first edges.
-- `inputs` and `outputs` are records of @NAME@_pkg; a field has the format beside it: I signed, U unsigned, bits before the
-- point (the sign among them) and, after F, those behind it. Taps are what a stage hands on; with --outputs-only nothing
-- compares them.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use work.@NAME@_pkg.all;

entity @NAME@_device is
  port (
    clk       : in  std_ulogic;
    rst       : in  std_ulogic;
    in_valid  : in  std_ulogic;
    in_ready  : out std_ulogic;
    inputs    : in  inputs_t;
    out_valid : out std_ulogic;
    out_ready : in  std_ulogic;
    outputs   : out outputs_t
  );
end entity;

architecture rtl of @NAME@_device is
begin

  -- A device without registers; one with registers delays valid and stops where out_ready is low.
  in_ready  <= out_ready;
  out_valid <= in_valid;

  -- The inputs:
@VHDL_INPUT_LIST@

@VHDL_ASSIGNMENTS@

end architecture;
