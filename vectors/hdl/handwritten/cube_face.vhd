-- SPEC section 6, "cube_face": the face that r meets and s, t on it.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

entity cube_face is
  generic (
    P     : positive := 20;
    K     : positive := 10;
    STEPS : natural  := 1;
    SEEDS : string   := "reciprocal_10.hex"
  );
  port (
    x, y, z      : in  signed(P + 1 downto 0);   -- mantissas of r
    face         : out unsigned(2 downto 0);
    s, t         : out signed(P + 1 downto 0);
    half_inverse : out signed(P + 1 downto 0);   -- 1/(2m)
    tie          : out std_ulogic
  );
end entity;

architecture rtl of cube_face is
  subtype mantissa_t is signed(P + 1 downto 0);
  constant ONE : mantissa_t := shift_left(to_signed(1, P + 2), P);

  signal m, s_c, t_c, h : mantissa_t;

  -- c/m, rounded once and cut to -1 to 1.
  function quotient(c, h : mantissa_t) return mantissa_t is
    variable product : signed(2 * P + 3 downto 0);
  begin
    product := c * h;
    product := shift_right(product + shift_left(to_signed(1, 2 * P + 4), P - 2), P - 1);
    return resize(maximum(resize(-ONE, 2 * P + 4), minimum(product, resize(ONE, 2 * P + 4))), P + 2);
  end function;
begin

  process (all) is
    variable ax, ay, az : mantissa_t;
    variable axis       : unsigned(1 downto 0);
    variable side       : unsigned(2 downto 0);
  begin
    ax := abs x;
    ay := abs y;
    az := abs z;
    -- z wins a tie over y, y over x; 0 is positive.
    if az >= ax and az >= ay then
      axis := "10";
      side := axis & z(z'left);
      m    <= az;
      tie  <= '1' when ax >= az or ay >= az else '0';
    elsif ay >= ax then
      axis := "01";
      side := axis & y(y'left);
      m    <= ay;
      tie  <= '1' when ax >= ay or az >= ay else '0';
    else
      axis := "00";
      side := axis & x(x'left);
      m    <= ax;
      tie  <= '1' when ay >= ax or az >= ax else '0';
    end if;
    face <= side;
    case side is
      when "000"  => s_c <= -z; t_c <= -y;
      when "001"  => s_c <= z;  t_c <= -y;
      when "010"  => s_c <= x;  t_c <= z;
      when "011"  => s_c <= x;  t_c <= -z;
      when "100"  => s_c <= x;  t_c <= -y;
      when others => s_c <= -x; t_c <= -y;
    end case;
  end process;

  inverse : entity work.half_reciprocal
    generic map (P, K, STEPS, SEEDS)
    port map (m, h);

  half_inverse <= h;
  s <= quotient(s_c, h);
  t <= quotient(t_c, h);

end architecture;
