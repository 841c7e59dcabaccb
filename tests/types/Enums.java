import java.io.ByteArrayOutputStream;
import java.io.DataOutputStream;
import lcm.lcm.LCMEncodable;
import other.level_t;
import rover.light_t;
import rover.lists_t;
import rover.mode_t;
import rover.ranger_t;
import rover.state_t;

/** Prints the payloads of messages with enums, in hexadecimal. */
class Enums {
    public static void main(String[] words) throws Exception {
        ranger_t ranger = new ranger_t();
        ranger.utime = 7;
        ranger.state = new state_t();
        ranger.state.mode = new mode_t(mode_t.OFF);
        ranger.mode = new mode_t(mode_t.FAST);
        ranger.light = new light_t(light_t.GREEN);
        ranger.level = new level_t(99);
        print(ranger);
        lists_t lists = new lists_t();
        lists.count = 3;
        lists.fixed = modes(1, 2);
        lists.varied = modes(0, 1, 5);
        lists.grid = new level_t[2][3];
        for (int row = 0; row < 2; row++) {
            for (int column = 0; column < 3; column++) {
                lists.grid[row][column] = new level_t(10 + 10 * row);
            }
        }
        print(lists);
    }

    private static mode_t[] modes(int... values) {
        mode_t[] found = new mode_t[values.length];
        for (int n = 0; n < values.length; n++) {
            found[n] = new mode_t(values[n]);
        }
        return found;
    }

    private static void print(LCMEncodable message) throws Exception {
        ByteArrayOutputStream bytes = new ByteArrayOutputStream();
        message.encode(new DataOutputStream(bytes));
        StringBuilder text = new StringBuilder();
        for (byte one : bytes.toByteArray()) {
            text.append(String.format("%02x", one));
        }
        System.out.println(text);
    }
}
