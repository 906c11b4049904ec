-- The hand-written cube_face as the device of a bench of that stage alone, for GHDL. In the folder of the bench that
--   roughxel vectors export random --stage cube_face -o sets
--   roughxel vectors bench sets/random_cube_face_standard.json --device blank -o benches
-- make it takes the place of random_cube_face_standard_device.vhd; cube_face.vhd, half_reciprocal.vhd and
-- reciprocal_10.hex (of the folder rom) stand in its rtl.
-- The names of the fields are those of the profile standard.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use work.random_cube_face_standard_pkg.all;

entity random_cube_face_standard_device is
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

architecture rtl of random_cube_face_standard_device is
  signal face         : unsigned(2 downto 0);
  signal half_inverse : signed(21 downto 0);
begin

  -- No registers: the handshake passes through.
  in_ready  <= out_ready;
  out_valid <= in_valid;

  dut : entity work.cube_face
    generic map (P => 20, K => 10, STEPS => 1, SEEDS => "rtl/reciprocal_10.hex")
    port map (
      x => inputs.reflect_r_m_0_i2f20, y => inputs.reflect_r_m_1_i2f20, z => inputs.reflect_r_m_2_i2f20,
      face => face, s => outputs.st_0_i2f20, t => outputs.st_1_i2f20, half_inverse => half_inverse,
      tie => outputs.tie_flag(0));

  -- The face in binary is its axis, then its sign.
  outputs.select_is_z_flag(0)     <= face(2);
  outputs.select_is_y_flag(0)     <= face(1);
  outputs.select_negative_flag(0) <= face(0);
  outputs.half_reciprocal_u1f20   <= unsigned(half_inverse(20 downto 0));

end architecture;
