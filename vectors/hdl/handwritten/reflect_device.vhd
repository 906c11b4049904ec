-- The hand-written reflect as the device of a bench of that stage alone, for GHDL. In the folder of the bench that
--   roughxel vectors export random --stage reflect -o sets
--   roughxel vectors bench sets/random_reflect_standard.json --device blank -o benches
-- make it takes the place of random_reflect_standard_device.vhd; reflect.vhd and normalise.vhd stand in its rtl.
-- The names of the fields are those of the profile standard.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use work.random_reflect_standard_pkg.all;

entity random_reflect_standard_device is
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

architecture rtl of random_reflect_standard_device is
  constant EW : positive := 20;

  signal n_m, v_m, r_m         : std_ulogic_vector(65 downto 0);
  signal scalars_m             : std_ulogic_vector(43 downto 0);
  signal n_e, v_e, r_e         : signed(EW - 1 downto 0);
  signal scalars_e             : signed(EW - 1 downto 0);
begin

  -- No registers: the handshake passes through.
  in_ready  <= out_ready;
  out_valid <= in_valid;

  n_m <= std_ulogic_vector(inputs.perturb_m_2_i2f20 & inputs.perturb_m_1_i2f20 & inputs.perturb_m_0_i2f20);
  v_m <= std_ulogic_vector(inputs.enter_view_m_2_i2f20 & inputs.enter_view_m_1_i2f20 & inputs.enter_view_m_0_i2f20);
  n_e <= resize(inputs.perturb_e_i18f0, EW);
  v_e <= resize(inputs.enter_view_e_i16f0, EW);

  dut : entity work.reflect
    generic map (P => 20, EW => EW)
    port map (n_m, n_e, v_m, v_e, r_m, r_e, scalars_m, scalars_e, outputs.below_flag(0));

  outputs.r_m_0_i2f20       <= signed(r_m(21 downto 0));
  outputs.r_m_1_i2f20       <= signed(r_m(43 downto 22));
  outputs.r_m_2_i2f20       <= signed(r_m(65 downto 44));
  outputs.r_e_i19f0         <= r_e(18 downto 0);
  outputs.scalars_m_0_i2f20 <= signed(scalars_m(21 downto 0));
  outputs.scalars_m_1_i2f20 <= signed(scalars_m(43 downto 22));
  outputs.scalars_e_i16f0   <= scalars_e(15 downto 0);

end architecture;
