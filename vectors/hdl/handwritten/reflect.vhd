-- SPEC section 6, "reflect": r = 2n<v.n> - v|n|^2 with the modified normal n. Vectors are packed, component x lowest.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

entity reflect is
  generic (
    P  : positive := 20;
    EW : positive := 20
  );
  port (
    n_m       : in  std_ulogic_vector(3 * (P + 2) - 1 downto 0);
    n_e       : in  signed(EW - 1 downto 0);
    v_m       : in  std_ulogic_vector(3 * (P + 2) - 1 downto 0);
    v_e       : in  signed(EW - 1 downto 0);
    r_m       : out std_ulogic_vector(3 * (P + 2) - 1 downto 0);
    r_e       : out signed(EW - 1 downto 0);
    scalars_m : out std_ulogic_vector(2 * (P + 2) - 1 downto 0);   -- <v.n> lowest, |n|^2
    scalars_e : out signed(EW - 1 downto 0);
    below     : out std_ulogic
  );
end entity;

architecture rtl of reflect is
  constant M  : positive := P + 2;
  constant PW : positive := 2 * M;   -- 2P fraction bits and values below 8

  signal vn, nn           : signed(PW - 1 downto 0);
  signal both             : std_ulogic_vector(2 * M - 1 downto 0);
  signal both_e, sum_of_e : signed(EW - 1 downto 0);
  signal exact            : std_ulogic_vector(3 * PW - 1 downto 0);

  function component_of(vector : std_ulogic_vector; i : natural) return signed is
  begin
    return signed(vector(i * M + M - 1 downto i * M));
  end function;

  function dot(a, b : std_ulogic_vector) return signed is
    variable sum : signed(PW - 1 downto 0) := (others => '0');
  begin
    for i in 0 to 2 loop
      sum := sum + component_of(a, i) * component_of(b, i);
    end loop;
    return sum;
  end function;
begin

  vn <= dot(v_m, n_m);
  nn <= dot(n_m, n_m);
  below <= '1' when vn <= 0 else '0';

  scalars : entity work.normalise
    generic map (N => 2, IW => PW, FB => 2 * P, P => P, EW => EW)
    port map (x => std_ulogic_vector(nn) & std_ulogic_vector(vn), e => to_signed(0, EW),
              mantissas => both, exponent => both_e);
  scalars_m <= both;
  scalars_e <= both_e;

  products : process (all) is
    variable twice, back : signed(PW - 1 downto 0);
  begin
    for i in 0 to 2 loop
      twice := shift_left(component_of(n_m, i) * component_of(both, 0), 1);
      back  := component_of(v_m, i) * component_of(both, 1);
      exact(i * PW + PW - 1 downto i * PW) <= std_ulogic_vector(twice - back);
    end loop;
  end process;

  sum_of_e <= both_e + v_e + shift_left(n_e, 1);

  r : entity work.normalise
    generic map (N => 3, IW => PW, FB => 2 * P, P => P, EW => EW)
    port map (x => exact, e => sum_of_e, mantissas => r_m, exponent => r_e);

end architecture;
