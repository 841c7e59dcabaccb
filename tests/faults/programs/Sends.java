import lcm.lcm.LCM;

/** Sends bytes: Sends CHANNEL HEX BYTES HERTZ, and listens to the channel "back". */
public class Sends {
    public static void main(String[] words) throws Exception {
        LCM bus = new LCM();
        byte[] data = new byte[Integer.parseInt(words[2])];
        for (int i = 0; i < words[1].length() / 2; i++) {
            data[i] = (byte) Integer.parseInt(words[1].substring(2 * i, 2 * i + 2), 16);
        }
        for (int sent = 0;; sent++) {
            bus.publish(words[0], data, 0, data.length);
            if (sent == 2) {
                System.out.println("ready");
            }
            Thread.sleep((long) (1000 / Double.parseDouble(words[3])));
        }
    }
}
