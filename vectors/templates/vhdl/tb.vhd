-- @NAME@_tb: drives @NAME@_device with every vector of the set @SET@ and compares every field.
--
-- VHDL-2008; `sh run.sh ghdl` has the command lines. Prints PASS, or each difference and FAIL; ERROR where the comparison
-- could not be made.

library ieee;
use ieee.std_logic_1164.all;
use ieee.numeric_std.all;
use std.textio.all;
use work.@NAME@_pkg.all;

entity @NAME@_tb is
  generic (
    WORDS        : string   := "words.hex";
    GOT          : string   := "";     -- writes the device's words there, all of them: STOP ends what is printed
    STOP         : positive := 10;     -- ends at that many vectors that differ
    OUTPUTS_ONLY : boolean  := false;  -- compares what leaves the datapath alone, for a device that does not show its stages
    STALLS       : boolean  := false;  -- both sides of the handshake pause at random
    TIMEOUT      : positive := 10000;  -- cycles without an output after which it gives up
    PLAYBACK     : boolean  := false;  -- the expected words in place of a device, to try the bench itself
    ALTERED      : integer  := -1      -- the vector that the playback alters; none is -1
  );
end entity;

architecture bench of @NAME@_tb is
  signal clk       : std_ulogic := '0';
  signal rst       : std_ulogic := '1';
  signal in_valid  : std_ulogic := '0';
  signal in_ready  : std_ulogic;
  signal inputs    : inputs_t;
  signal out_valid : std_ulogic;
  signal out_ready : std_ulogic := '0';
  signal outputs   : outputs_t;
  signal noise     : std_ulogic_vector(15 downto 0) := x"ace1";
  signal is_done   : boolean := false;

  procedure say(text_of_line : string) is
    variable row : line;
  begin
    write(row, text_of_line);
    writeline(output, row);
  end procedure;
begin

  device : if PLAYBACK generate
    played : entity work.@NAME@_playback
      generic map (WORDS, ALTERED)
      port map (clk, rst, in_valid, in_ready, inputs, out_valid, out_ready, outputs);
  else generate
    driven : entity work.@NAME@_device
      port map (clk, rst, in_valid, in_ready, inputs, out_valid, out_ready, outputs);
  end generate;

  clk <= not clk after 1 ns when not is_done;

  noise <= noise(14 downto 0) & (noise(15) xor noise(13) xor noise(12) xor noise(10)) when rising_edge(clk);

  -- Inputs change behind the rising edge and stay until they are taken.
  drive : process is
    file     driven  : text open read_mode is WORDS;
    variable word    : word_t;
    variable is_good : boolean;
  begin
    for i in 1 to 3 loop
      wait until falling_edge(clk);
    end loop;
    rst <= '0';
    for index in 0 to N_VECTORS - 1 loop
      read_word(driven, word, is_good);
      if not is_good or not is_whole(word) then
        say("ERROR " & WORDS & ": word " & to_string(index) & " of " & to_string(N_VECTORS)
            & " is missing or damaged; make the bench again");
        std.env.stop(1);
      end if;
      while STALLS and noise(2 downto 0) = "000" loop
        wait until falling_edge(clk);
      end loop;
      inputs <= inputs_of(word);
      in_valid <= '1';
      wait until rising_edge(clk) and in_ready = '1';
      wait until falling_edge(clk);
      in_valid <= '0';
    end loop;
    wait;
  end process;

  ready : process (clk) is
  begin
    if falling_edge(clk) then
      out_ready <= '1' when not STALLS or noise(10 downto 9) /= "00" else '0';
    end if;
  end process;

  check : process is
    constant KEEPS     : boolean := GOT'length > 0;
    file     wanted    : text open read_mode is WORDS;
    file     given     : text;
    variable status    : file_open_status;
    variable is_open   : boolean := false;
    variable row       : line;
    variable word      : word_t;
    variable is_good   : boolean;
    variable checked   : natural := 0;
    variable wrong     : natural := 0;
    variable idle      : natural := 0;
    variable differing : natural;
  begin
    if KEEPS and not is_open then
      file_open(status, given, GOT, write_mode);
      if status /= open_ok then
        say("ERROR " & GOT & " cannot be written");
        std.env.stop(1);
      end if;
      is_open := true;
    end if;
    wait until rising_edge(clk);
    if rst = '1' then
      null;
    elsif (out_valid and out_ready) = '1' then
      idle := 0;
      if checked = N_VECTORS then
        say("ERROR an output after the last of " & to_string(N_VECTORS) & " vectors");
        std.env.stop(1);
      end if;
      read_word(wanted, word, is_good);
      if KEEPS then
        write(row, digits(with_outputs(word, outputs)));
        writeline(given, row);
      end if;
      compare(checked, outputs_of(word), outputs, OUTPUTS_ONLY, KEEPS and wrong >= STOP, differing);
      checked := checked + 1;
      if differing > 0 then
        wrong := wrong + 1;
        if wrong = STOP and not KEEPS then
          say("FAIL @SET@: " & to_string(wrong) & " of " & to_string(checked) & " vectors differ, stopped there");
          std.env.stop(3);
        end if;
      end if;
    else
      idle := idle + 1;
    end if;
    -- A device that gives one output too many does so soon.
    if checked = N_VECTORS and idle > 100 then
      is_done <= true;
      if KEEPS then
        file_close(given);
      end if;
      if wrong = 0 then
        say("PASS @SET@: " & to_string(checked) & " vectors");
        std.env.stop(0);
      else
        say("FAIL @SET@: " & to_string(wrong) & " of " & to_string(checked) & " vectors differ");
        std.env.stop(3);
      end if;
    elsif idle > TIMEOUT then
      say("ERROR only " & to_string(checked) & " of " & to_string(N_VECTORS) & " outputs came: none for "
          & to_string(TIMEOUT) & " cycles");
      std.env.stop(1);
    end if;
  end process;

end architecture;
