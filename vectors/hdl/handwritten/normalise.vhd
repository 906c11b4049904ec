-- SPEC section 3, "normalise": N integers with FB fraction bits and one exponent become a block of mantissas with P fraction bits.
-- Components are packed, the first one lowest. The exponent of zeros is -2^15.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;

entity normalise is
  generic (
    N  : positive := 3;    -- components
    IW : positive := 44;   -- bits of an input component, more than P + 2
    FB : positive := 40;   -- its fraction bits
    P  : positive := 20;   -- fraction bits kept in a mantissa
    EW : positive := 20    -- bits of an exponent inside the datapath
  );
  port (
    x         : in  std_ulogic_vector(N * IW - 1 downto 0);
    e         : in  signed(EW - 1 downto 0);
    mantissas : out std_ulogic_vector(N * (P + 2) - 1 downto 0);
    exponent  : out signed(EW - 1 downto 0)
  );
end entity;

architecture rtl of normalise is
begin

  process (all) is
    variable span    : std_ulogic_vector(IW - 1 downto 0);   -- or of the magnitudes, negative ones as not x
    variable part    : signed(IW - 1 downto 0);
    variable rounded : signed(IW downto 0);
    variable top     : natural;                              -- bits of the longest component
  begin
    span := (others => '0');
    for i in 0 to N - 1 loop
      part := signed(x(i * IW + IW - 1 downto i * IW));
      span := span or (std_ulogic_vector(part) xor (span'range => part(part'left)));
    end loop;
    top := 0;
    for i in span'reverse_range loop
      if span(i) = '1' then
        top := i + 1;
      end if;
    end loop;
    for i in 0 to N - 1 loop
      part    := signed(x(i * IW + IW - 1 downto i * IW));
      -- The longest component fills all bits; then one rounding.
      rounded := resize(shift_left(part, IW - 1 - top), IW + 1)
                 + shift_left(to_signed(1, IW + 1), IW - 2 - P);
      mantissas(i * (P + 2) + P + 1 downto i * (P + 2)) <= std_ulogic_vector(rounded(IW downto IW - 1 - P));
    end loop;
    if x = (x'range => '0') then
      exponent <= to_signed(-2 ** 15, EW);
    else
      exponent <= e + top - FB;
    end if;
  end process;

end architecture;
